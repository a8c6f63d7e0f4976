#include "pipelines/localization/sensing.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pipelines/localization/position_index.h"

namespace cairn::localization {
namespace {

TEST(MeanFeatures, AreTheMeanOfTheNearestSamplesAndThePriorCount) {
  const PositionIndex index({{0, 0}, {1, 0}, {2, 0}, {9, 0}});
  const std::vector<double> output = {0.2, 1.0, 0.4, 1.0, 0.6, 1.0, 0.0, 0.0};  // two features
  const std::vector<double> plain = MeanFeatures(index.Nearest({1.1, 0}, 3), output, 2, 0.0);
  EXPECT_NEAR(plain[0], 0.4, 1e-15);
  EXPECT_NEAR(plain[1], 1.0, 1e-15);
  const std::vector<double> smooth = MeanFeatures(index.Nearest({1.1, 0}, 3), output, 2, 0.5);
  EXPECT_NEAR(smooth[0], (1.2 + 0.5) / 4, 1e-15);
  EXPECT_NEAR(smooth[1], (3.0 + 0.5) / 4, 1e-15);
}

// The product over bits against the sum over all feature vectors that it stands for.
TEST(Likelihood, IsTheExpectationOverTheFeatureVector) {
  Rng rng(3);
  constexpr std::size_t kFeatures = 4, kPositions = 5;
  std::vector<double> map, output;
  for (std::size_t i = 0; i < kFeatures * kPositions; ++i) map.push_back(rng.Uniform());
  for (std::size_t i = 0; i < kFeatures; ++i) output.push_back(rng.Uniform());
  const auto probability = [](const double* ones, std::size_t f) {
    double product = 1.0;
    for (std::size_t i = 0; i < kFeatures; ++i) product *= (f >> i & 1) != 0 ? ones[i] : 1.0 - ones[i];
    return product;
  };
  const std::vector<double> likelihood = Likelihood(map, output, {0, kFeatures}, 1.0);
  ASSERT_EQ(likelihood.size(), kPositions);
  for (std::size_t position = 0; position < kPositions; ++position) {
    double expected = 0.0;
    for (std::size_t f = 0; f < 1U << kFeatures; ++f)
      expected += probability(output.data(), f) * probability(&map[position * kFeatures], f);
    EXPECT_NEAR(likelihood[position], expected, 1e-14);
  }
  const std::vector<double> drawn = {1, 0, 0, 1};
  EXPECT_NEAR(Likelihood(map, drawn, {0, kFeatures}, 1.0)[2], probability(&map[2 * kFeatures], 9), 1e-15);
  EXPECT_NEAR(Likelihood(map, drawn, {0, kFeatures}, 0.5)[2], std::sqrt(probability(&map[2 * kFeatures], 9)),
              1e-15);
  EXPECT_NEAR(Likelihood(map, drawn, {1, 3}, 1.0)[2], (1 - map[9]) * (1 - map[10]), 1e-15);
}

TEST(Drawn, ComesUpAsOftenAsItsProbability) {
  Rng rng(4);
  int ones[2] = {0, 0};
  for (int k = 0; k < 20000; ++k) {
    const std::vector<double> f = Drawn({0.25, 1.0}, rng);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_TRUE(f[i] == 0.0 || f[i] == 1.0);
      ones[i] += f[i] == 1.0 ? 1 : 0;
    }
  }
  EXPECT_NEAR(ones[0] / 20000.0, 0.25, 0.01);
  EXPECT_EQ(ones[1], 20000);
}

}  // namespace
}  // namespace cairn::localization
