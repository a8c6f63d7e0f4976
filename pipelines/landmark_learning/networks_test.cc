#include "pipelines/landmark_learning/networks.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pipelines/landmark_learning/features.h"
#include "pipelines/landmark_learning/posterior_error.h"

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

// From the weights to E_posterior, by every parameter.
TEST(Networks, TheGradientOfTheErrorIsThatOfFiniteDifferences) {
  constexpr int kSamples = 60, kNetworks = 3;
  const NetworkShape shape{kNetworks, 5, 4};
  Rng rng(11);
  Places places;
  std::vector<double> inputs, weight(kSamples, 1.0 / kSamples);
  for (int k = 0; k < kSamples; ++k) {
    places.x_m.push_back(0.4 * k);
    places.y_m.push_back(0.1 * rng.Normal());
    places.along_m.push_back(0.4 * k);
    for (int i = 0; i < shape.inputs; ++i) inputs.push_back(std::sin(0.1 * k * (i + 1)) + 0.3 * rng.Normal());
  }
  Parameters<double> parameters = RandomParameters<double>(shape, 1.0, rng);
  const auto share = [&](const Activations<double>& a) {
    return ErrorOfTruths(Pairs(places, places, {BeliefShape::kUniform, 5.0}, ErrorKind::kDistance),
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

}  // namespace
}  // namespace cairn::landmark_learning
