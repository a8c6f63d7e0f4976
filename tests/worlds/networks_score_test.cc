// What evaluates networks shares no code with what trains them: both must come to the same numbers.
#include <gtest/gtest.h>

#include "datasets/evaluate/learning/feature_map.h"
#include "datasets/evaluate/learning/learned_networks.h"
#include "pipelines/landmark_learning/error_sum/features.h"
#include "pipelines/landmark_learning/error_sum/posterior_error.h"
#include "pipelines/landmark_learning/networks/networks.h"

namespace cairn {
namespace {

namespace learning = landmark_learning;

// The same networks as evaluation has them: [networks][units][what they see], where training has the inputs
// first.
datasets::LearnedNetworks AsStored(const learning::Parameters<double>& w) {
  const learning::NetworkShape& s = w.shape;
  datasets::LearnedNetworks nets;
  nets.networks = static_cast<std::size_t>(s.networks);
  nets.hidden = static_cast<std::size_t>(s.hidden);
  nets.hidden_2 = static_cast<std::size_t>(s.hidden_2);
  nets.inputs = static_cast<std::size_t>(s.inputs);
  nets.input_mean.assign(nets.inputs, 0.0);
  nets.input_scale.assign(nets.inputs, 1.0);
  for (int unit = 0; unit < s.units(); ++unit) {
    for (int i = 0; i < s.inputs; ++i) nets.hidden_weight.push_back(w.HiddenWeights(i)[unit]);
  }
  for (int n = 0; n < s.networks; ++n) {
    for (int u = 0; u < s.hidden_2; ++u) {
      for (int h = 0; h < s.hidden; ++h)
        nets.hidden_2_weight.push_back(w.SecondWeights()[(n * s.hidden + h) * s.hidden_2 + u]);
    }
  }
  nets.hidden_bias.assign(w.HiddenBiases(), w.HiddenBiases() + s.units());
  nets.hidden_2_bias.assign(w.SecondBiases(), w.SecondBiases() + s.networks * s.hidden_2);
  nets.output_weight.assign(w.OutputWeights(), w.OutputWeights() + s.last_units());
  nets.output_bias.assign(w.OutputBiases(), w.OutputBiases() + s.networks);
  return nets;
}

std::vector<float> RandomInputs(int rows, int inputs, Rng& rng) {
  std::vector<float> input;
  for (int i = 0; i < rows * inputs; ++i) input.push_back(static_cast<float>(rng.Normal()));
  return input;
}

TEST(NetworksScore, TrainingAndEvaluationComputeTheSameOutputs) {
  Rng rng(5);
  for (const int hidden_2 : {0, 7}) {
    const learning::NetworkShape shape{.networks = 3, .inputs = 5, .hidden = 4, .hidden_2 = hidden_2};
    const auto parameters = learning::RandomParameters<double>(shape, 2.0, rng);
    const std::vector<float> input = RandomInputs(40, shape.inputs, rng);
    const std::vector<double> wide(input.begin(), input.end());
    const auto theirs = learning::Forward(parameters, wide.data(), 40).output;
    const auto ours = datasets::OutputsOf(AsStored(parameters), input);
    ASSERT_EQ(ours.size(), theirs.size());
    for (std::size_t i = 0; i < ours.size(); ++i) EXPECT_NEAR(ours[i], theirs[i], 1e-12) << hidden_2;
  }
}

TEST(NetworksScore, TrainingAndEvaluationComputeTheSameErrorsInAMap) {
  Rng rng(6);
  std::vector<Point> positions;
  learning::Positions samples, true_positions;
  std::vector<double> output, at_true_positions;
  for (int k = 0; k < 150; ++k) {
    positions.push_back({0.3 * k, rng.Uniform(0, 1)});
    samples.x_m.push_back(positions.back().x_m);
    samples.y_m.push_back(positions.back().y_m);
    samples.along_m.push_back(0);
    for (int i = 0; i < 3; ++i) output.push_back(rng.Uniform());
  }
  for (int a = 0; a < 60; ++a) {
    true_positions.x_m.push_back(rng.Uniform(0, 45));
    true_positions.y_m.push_back(rng.Uniform(0, 1));
    true_positions.along_m.push_back(0);
    for (int i = 0; i < 3; ++i) at_true_positions.push_back(rng.Uniform());
  }
  const datasets::FeatureMap map = datasets::MapByNearest(positions, output, 3, 5);
  const auto of_true_positions = learning::FeatureProbabilities(at_true_positions, 3);
  const std::vector<double> weight(60, 1.0), windows_m = {2, 10, 100};
  std::vector<double> prior(3, 0.0), posterior(3, 0.0);
  for (std::size_t a = 0; a < 60; ++a) {
    const auto p = datasets::FeatureProbabilities(std::span(at_true_positions).subspan(3 * a, 3));
    const auto errors =
        datasets::ErrorsInMap(map, {true_positions.x_m[a], true_positions.y_m[a]}, p, {}, windows_m);
    for (std::size_t w = 0; w < 3; ++w) {
      prior[w] += errors[w].prior_m;
      posterior[w] += errors[w].soft_m;
    }
  }
  for (std::size_t w = 0; w < 3; ++w) {
    const learning::Belief belief{.width_m = windows_m[w]};
    const learning::Pairs pairs(true_positions, samples, belief, learning::ErrorKind::kDistance);
    const double theirs = learning::ErrorInMap(pairs, of_true_positions, map.probability, 8, weight, {0, 60});
    EXPECT_GT(theirs, 10);
    EXPECT_NEAR(posterior[w], theirs, 1e-10 * theirs);
    EXPECT_NEAR(prior[w], learning::PriorErrorOfTruePositions(pairs, weight, {0, 60}), 1e-10 * prior[w]);
  }
}

}  // namespace
}  // namespace cairn
