#include "pipelines/localization/look.h"

#include <gtest/gtest.h>

#include "schema/error.h"
#include "schema/rng.h"

namespace cairn::localization {
namespace {

// Four positions, 1 m apart, the belief even; a feature that halves them, one that alternates, one that says
// nothing.
const std::vector<Position> kPositions = {{0, 0}, {1, 0}, {2, 0}, {3, 0}};
const std::vector<double> kEven = {0.25, 0.25, 0.25, 0.25};
const std::vector<double> kMap = {0, 0, 0.5, 0, 1, 0.5, 1, 0, 0.5, 1, 1, 0.5};

TEST(ExpectedError, IsWhatALookLeavesByHand) {
  // Nothing learned: the mean distance of two positions drawn evenly, 20 / 16.
  EXPECT_NEAR(ExpectedError(kPositions, kEven, kMap, 3, {2, 3}), 1.25, 1e-12);
  // Halves: two positions 1 m apart.
  EXPECT_NEAR(ExpectedError(kPositions, kEven, kMap, 3, {0, 1}), 0.5, 1e-12);
  // Every other position: two positions 2 m apart.
  EXPECT_NEAR(ExpectedError(kPositions, kEven, kMap, 3, {1, 2}), 1.0, 1e-12);
  // What cannot be seen from where the robot may be, here the right half, counts for nothing.
  EXPECT_NEAR(ExpectedError(kPositions, {0.5, 0.5, 0, 0}, kMap, 3, {0, 1}), 0.5, 1e-12);
  // Both name each position.
  EXPECT_NEAR(ExpectedError(kPositions, kEven, kMap, 3, {0, 2}), 0.0, 1e-12);
}

// Against the sum of [Thr98] eq. 22 as it stands: truth, feature vector, position.
TEST(ExpectedError, EqualsTheLiteralSum) {
  Rng rng(8);
  std::vector<Position> positions;
  std::vector<double> belief, map;
  double sum = 0.0;
  for (int k = 0; k < 7; ++k) {
    positions.push_back({rng.Uniform(0, 9), rng.Uniform(0, 2)});
    belief.push_back(rng.Uniform(0.1, 1));
    sum += belief.back();
    for (int i = 0; i < 3; ++i) map.push_back(rng.Uniform());
  }
  for (double& b : belief) b /= sum;
  const auto probability = [&](std::size_t k, std::size_t f) {
    double product = 1.0;
    for (std::size_t i = 0; i < 3; ++i) product *= (f >> i & 1) != 0 ? map[3 * k + i] : 1.0 - map[3 * k + i];
    return product;
  };
  double expected = 0.0;
  for (std::size_t truth = 0; truth < 7; ++truth) {
    for (std::size_t f = 0; f < 8; ++f) {
      double z = 0.0, error = 0.0;
      for (std::size_t k = 0; k < 7; ++k) {
        z += belief[k] * probability(k, f);
        error += belief[k] * probability(k, f) * DistanceM(positions[truth], positions[k]);
      }
      expected += belief[truth] * probability(truth, f) * error / z;
    }
  }
  EXPECT_NEAR(ExpectedError(positions, belief, map, 3, {0, 3}), expected, 1e-12);
}

TEST(BestLook, DependsOnWhatIsBelieved) {
  const std::vector<FeatureGroup> groups = {{2, 3}, {0, 1}, {1, 2}};
  EXPECT_EQ(BestLook(kPositions, kEven, kMap, 3, groups), 1U);
  EXPECT_EQ(BestLook(kPositions, {0.5, 0.5, 0.0, 0.0}, kMap, 3, groups), 2U);  // halves say nothing any more
}

TEST(RequireWeighable, RefusesWhatTakesForEver) {
  RequireWeighable({{0, 12}, {12, 24}});
  RequireWeighable({{0, 40}});  // nothing to choose from
  EXPECT_THROW(RequireWeighable({{0, 4}, {4, 17}}), InputError);
}

}  // namespace
}  // namespace cairn::localization
