#include "pipelines/landmark_learning/networks/networks.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pipelines/landmark_learning/error_sum/features.h"
#include "pipelines/landmark_learning/error_sum/posterior_error.h"

namespace cairn::landmark_learning {
namespace {

double Sigmoid(double x) { return 1.0 / (1.0 + std::exp(-x)); }

TEST(Networks, AreWhatTheFormatSays) {
  Parameters<double> p({.networks = 2, .inputs = 2, .hidden = 1});
  p.values = {0.5, -1.0, 2.0, 0.25, 0.1, -0.2, 1.5, -3.0, 0.7, 0.3};  // v of both inputs, a, w, b
  const double x[] = {0.4, -0.6};
  const auto out = Forward(p, x, 1);
  const double first = Sigmoid(0.1 + 0.5 * 0.4 + 2.0 * -0.6),
               second = Sigmoid(-0.2 - 1.0 * 0.4 + 0.25 * -0.6);
  EXPECT_NEAR(out.output[0], Sigmoid(0.7 + 1.5 * first), 1e-15);
  EXPECT_NEAR(out.output[1], Sigmoid(0.3 - 3.0 * second), 1e-15);
}

// The first layer's outputs go into the second's units of the same network alone.
TEST(Networks, OfTwoLayersAreWhatTheFormatSays) {
  Parameters<double> p({.networks = 2, .inputs = 1, .hidden = 2, .hidden_2 = 1});
  p.values = {0.5,  -1.0, 2.0, 0.25, 0.1, -0.2, 0.3, -0.4,  // v and a of both units of both networks
              1.5,  -3.0, 0.7, 0.9,  0.6, -0.8,             // u and c
              -2.0, 4.0,  0.2, -0.1};                       // w and b
  const double x[] = {0.4};
  const auto out = Forward(p, x, 1);
  const auto unit = [&](double v, double a) { return Sigmoid(a + v * 0.4); };
  const double first = Sigmoid(0.6 + 1.5 * unit(0.5, 0.1) - 3.0 * unit(-1.0, -0.2)),
               second = Sigmoid(-0.8 + 0.7 * unit(2.0, 0.3) + 0.9 * unit(0.25, -0.4));
  EXPECT_NEAR(out.output[0], Sigmoid(0.2 - 2.0 * first), 1e-15);
  EXPECT_NEAR(out.output[1], Sigmoid(-0.1 + 4.0 * second), 1e-15);
}

// The kernel in float against the oracle in double, more units than a register holds.
TEST(Networks, InFloatAreThoseInDouble) {
  for (const int hidden_2 : {0, 3, 9}) {
    const NetworkShape shape{.networks = 3, .inputs = 7, .hidden = 5, .hidden_2 = hidden_2};
    constexpr int kRows = 70;
    Rng rng(4);
    const auto exact = RandomParameters<double>(shape, 1.0, rng);
    Parameters<float> rounded(shape);
    std::vector<double> inputs, d_output;
    for (std::size_t i = 0; i < exact.values.size(); ++i)
      rounded.values[i] = static_cast<float>(exact.values[i]);
    for (int i = 0; i < kRows * shape.inputs; ++i) inputs.push_back(rng.Normal());
    for (int i = 0; i < kRows * shape.networks; ++i) d_output.push_back(rng.Normal());
    const std::vector<float> in_float(inputs.begin(), inputs.end());
    const auto wanted = Forward(exact, inputs.data(), kRows);
    const auto got = Forward(rounded, in_float.data(), kRows);
    ASSERT_EQ(wanted.output.size(), static_cast<std::size_t>(kRows * shape.networks));
    ASSERT_EQ(got.output.size(), wanted.output.size());
    for (std::size_t i = 0; i < wanted.output.size(); ++i)
      EXPECT_NEAR(got.output[i], wanted.output[i], 1e-6) << hidden_2;
    const auto by_weights = Backward(exact, inputs.data(), kRows, wanted, d_output);
    const auto in_floats = Backward(rounded, in_float.data(), kRows, got, {d_output.begin(), d_output.end()});
    for (std::size_t i = 0; i < by_weights.values.size(); ++i)
      EXPECT_NEAR(in_floats.values[i], by_weights.values[i], 1e-5) << hidden_2 << ", " << i;
  }
}

// From the weights to E_posterior, by every parameter.
void ExpectGradientOfFiniteDifferences(const NetworkShape& shape) {
  constexpr int kSamples = 60, kNetworks = 3;
  ASSERT_EQ(shape.networks, kNetworks);
  Rng rng(11);
  Positions positions;
  std::vector<double> inputs, weight(kSamples, 1.0 / kSamples);
  for (int k = 0; k < kSamples; ++k) {
    positions.x_m.push_back(0.4 * k);
    positions.y_m.push_back(0.1 * rng.Normal());
    positions.along_m.push_back(0.4 * k);
    for (int i = 0; i < shape.inputs; ++i) inputs.push_back(std::sin(0.1 * k * (i + 1)) + 0.3 * rng.Normal());
  }
  Parameters<double> parameters = RandomParameters<double>(shape, 1.0, rng);
  const auto share = [&](const Activations<double>& a) {
    return ErrorOfTruePositions(
        Pairs(positions, positions, {BeliefShape::kUniform, 5.0}, ErrorKind::kDistance),
        FeatureProbabilities(a.output, kNetworks), 1 << kNetworks, weight, {0, kSamples});
  };
  const auto activations = Forward(parameters, inputs.data(), kSamples);
  const auto gradient =
      Backward(parameters, inputs.data(), kSamples, activations,
               OutputGradient(activations.output, kNetworks, share(activations).d_probability));
  double largest = 0.0;
  for (const double slope : gradient.values) largest = std::max(largest, std::abs(slope));
  ASSERT_GT(largest, 1e-4);
  for (std::size_t i = 0; i < parameters.values.size(); ++i) {
    const double at = parameters.values[i];
    const auto error_at = [&](double step) {
      parameters.values[i] = at + step;
      const double error = share(Forward(parameters, inputs.data(), kSamples)).posterior;
      parameters.values[i] = at;
      return error;
    };
    constexpr double kStep = 2e-3;
    const double slope =
        (8.0 * (error_at(kStep) - error_at(-kStep)) - (error_at(2 * kStep) - error_at(-2 * kStep))) /
        (12.0 * kStep);
    EXPECT_NEAR(gradient.values[i], slope, 1e-6 * std::max(std::abs(gradient.values[i]), 1e-3 * largest))
        << i;
  }
}

TEST(Networks, TheGradientOfTheErrorIsThatOfFiniteDifferences) {
  ExpectGradientOfFiniteDifferences({.networks = 3, .inputs = 5, .hidden = 4});
  ExpectGradientOfFiniteDifferences({.networks = 3, .inputs = 5, .hidden = 4, .hidden_2 = 3});
}

}  // namespace
}  // namespace cairn::landmark_learning
