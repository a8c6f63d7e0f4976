#include "pipelines/landmark_learning/block_task.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipelines/landmark_learning/features.h"
#include "pipelines/landmark_learning/posterior_error.h"

namespace cairn::landmark_learning {
namespace {

Places Part(const Places& places, const Range& range) {
  const auto part = [&](const std::vector<double>& values) {
    return std::vector<double>(values.begin() + range.first, values.begin() + range.end);
  };
  return {part(places.x_m), part(places.y_m), part(places.along_m)};
}

// P(a): every truth is as likely as another.
std::vector<double> EvenWeights(int count, int of) {
  return std::vector<double>(static_cast<std::size_t>(count), 1.0 / of);
}

const float* RowsFrom(const SampleSet& set, int first, int inputs) {
  return set.inputs() + static_cast<std::ptrdiff_t>(first) * inputs;
}

}  // namespace

Belief BeliefOf(const Options& options) {
  return {options.belief == "gaussian" ? BeliefShape::kGaussian : BeliefShape::kUniform,
          options.window_m > 0.0 ? options.window_m : std::numeric_limits<double>::infinity()};
}

ErrorKind ErrorOf(const Options& options) {
  if (options.error == "squared") return ErrorKind::kSquaredDistance;
  return options.error == "along" ? ErrorKind::kAlong : ErrorKind::kDistance;
}

GradientShare GradientOfBlock(const Options& options, const SampleSet& training,
                              const Parameters<float>& parameters, const Range& truths) {
  const NetworkShape& shape = parameters.shape;
  const Belief belief = BeliefOf(options);
  const Pairs all(training.places, training.places, belief, ErrorOf(options));
  Range reach = all.ReachOf(truths);
  reach = {std::min(reach.first, truths.first), std::max(reach.end, truths.end)};
  const Places places = Part(training.places, reach);
  const float* rows = RowsFrom(training, reach.first, shape.inputs);
  const auto activations = Forward(parameters, rows, reach.size());
  const int vectors = static_cast<int>(FeatureVectors(shape.networks));
  const auto share = ErrorOfTruths(Pairs(places, places, belief, ErrorOf(options)),
                                   FeatureProbabilities(activations.output, shape.networks), vectors,
                                   EvenWeights(reach.size(), training.size()),
                                   {truths.first - reach.first, truths.end - reach.first});
  const auto gradient = Backward(parameters, rows, reach.size(), activations,
                                 OutputGradient(activations.output, shape.networks, share.d_probability));
  return {share.posterior, gradient.values};
}

double ValidationOfBlock(const Options& options, const TrainingData& data,
                         const Parameters<float>& parameters, const Range& truths) {
  const NetworkShape& shape = parameters.shape;
  const Belief belief = BeliefOf(options);
  const Range reach =
      Pairs(data.held_out.places, data.training.places, belief, ErrorOf(options)).ReachOf(truths);
  const Places sensed = Part(data.held_out.places, truths), map = Part(data.training.places, reach);
  const auto of_truth =
      Forward(parameters, RowsFrom(data.held_out, truths.first, shape.inputs), truths.size());
  const auto of_sample =
      Forward(parameters, RowsFrom(data.training, reach.first, shape.inputs), reach.size());
  return ErrorInMap(Pairs(sensed, map, belief, ErrorOf(options)),
                    FeatureProbabilities(of_truth.output, shape.networks),
                    FeatureProbabilities(of_sample.output, shape.networks),
                    static_cast<int>(FeatureVectors(shape.networks)),
                    EvenWeights(truths.size(), data.held_out.size()), {0, truths.size()});
}

std::vector<Range> Blocks(int count, int samples, int networks) {
  constexpr double kFlops = 4e8;  // of a task, at 8 K^2 2^n in all
  const double flops = 8.0 * count * samples * static_cast<double>(FeatureVectors(networks));
  const int blocks =
      std::clamp(static_cast<int>(std::ceil(flops / kFlops)), 1, std::max(1, std::min(count, 4096)));
  std::vector<Range> ranges;
  for (int b = 0; b < blocks; ++b) {
    const auto at = [&](std::int64_t i) { return static_cast<int>(i * count / blocks); };
    ranges.push_back({at(b), at(b + 1)});
  }
  return ranges;
}

}  // namespace cairn::landmark_learning
