#include "datasets/evaluate/learning/feature_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "schema/rng.h"

namespace cairn::datasets {
namespace {

TEST(FeatureProbabilities, AreProductsWithBitIForNetworkI) {
  const std::vector<double> p = FeatureProbabilities(std::vector<double>{0.25, 0.9});
  ASSERT_EQ(p.size(), 4U);
  EXPECT_DOUBLE_EQ(p[0], 0.75 * (1 - 0.9));
  EXPECT_DOUBLE_EQ(p[1], 0.25 * (1 - 0.9));
  EXPECT_DOUBLE_EQ(p[2], 0.75 * 0.9);
  EXPECT_DOUBLE_EQ(p[3], 0.25 * 0.9);
}

// Samples at 0, 1, 3, 7 m: the two nearest of each are {0, 1}, {1, 0}, {3, 1}, {7, 3}. At 5 m 3 and 7 are as
// near.
TEST(MapByNearest, AveragesEachNetworkOverTheNearestByHand) {
  const std::vector<Point> positions = {{0, 0}, {1, 0}, {3, 0}, {7, 0}};
  const std::vector<double> g = {0.0, 0.2, 0.6, 1.0};
  const FeatureMap map = MapByNearest(positions, g, 1, 2);
  const std::vector<double> mean = {0.1, 0.1, 0.4, 0.8};
  ASSERT_EQ(map.probability.size(), 8U);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(map.probability[2 * k], 1 - mean[k], 1e-15);
    EXPECT_NEAR(map.probability[2 * k + 1], mean[k], 1e-15);
  }
  const FeatureMap all = MapByNearest(positions, g, 1, 4);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(all.probability[2 * k + 1], 0.45, 1e-15);
}

// The product of means, not the mean of products: g = (0, 0) and (1, 1) give 1/4 for each f.
TEST(MapByNearest, IsAProductOfMeans) {
  const FeatureMap map = MapByNearest({{0, 0}, {1, 0}}, std::vector<double>{0, 0, 1, 1}, 2, 2);
  ASSERT_EQ(map.probability.size(), 2U << 2U);
  for (const double p : map.probability) EXPECT_DOUBLE_EQ(p, 0.25);
}

TEST(MapByNearest, PrefersTheFirstOfSamplesThatAreEquallyNear) {
  const FeatureMap map = MapByNearest({{-1, 0}, {0, 0}, {1, 0}}, std::vector<double>{1, 0, 0}, 1, 2);
  EXPECT_DOUBLE_EQ(map.probability[3], 0.5);
}

// There and back, and one sideways: nearest are those of the ones that face alike, all of them where they are
// too few.
TEST(MapByNearest, TakesSamplesThatFaceAlikeWhereHeadingsCount) {
  const std::vector<Point> positions = {{0, 0}, {0.1, 0}, {1, 0}, {1.1, 0}, {2, 0}};
  const std::vector<double> g = {0.0, 1.0, 0.2, 0.6, 0.4}, heading_rad = {0.0, 3.1, 0.2, -3.1, 1.4};
  const FeatureMap map = MapByNearest(positions, g, 1, 2, heading_rad);
  const std::vector<double> mean = {0.1, 0.8, 0.1, 0.8, 0.3};
  for (std::size_t k = 0; k < 5; ++k) EXPECT_NEAR(map.probability[2 * k + 1], mean[k], 1e-15) << k;
  const FeatureMap more = MapByNearest(positions, g, 1, 4, heading_rad);
  EXPECT_NEAR(more.probability[2 * 1 + 1], 0.8, 1e-15);
  EXPECT_NEAR(more.probability[2 * 2 + 1], 0.2, 1e-15);
}

// Of the positions at 0, 1, 4 m below the one at 1 m faces back: who knows it faces forward does not believe
// in it.
TEST(ErrorsInMap, PositionsThatFaceAnotherWayAreOutOfTheHeadingsWindow) {
  const FeatureMap map{.positions = {{0, 0}, {1, 0}, {4, 0}},
                       .vectors = 2,
                       .probability = {0.2, 0.8, 0.7, 0.3, 0.5, 0.5},
                       .heading_rad = {0.1, 3.1, -0.1}};
  const std::vector<double> p = {0.4, 0.6};
  const WindowError knows = ErrorsInMap(map, {0, 0}, p, {}, {100}, {0.0, 1.5})[0];
  EXPECT_EQ(knows.positions, 2U);
  EXPECT_DOUBLE_EQ(knows.prior_m, 2);
  EXPECT_DOUBLE_EQ(knows.soft_m, 0.4 * 4 * 0.5 / 0.7 + 0.6 * 4 * 0.5 / 1.3);
  const WindowError does_not = ErrorsInMap(map, {0, 0}, p, {}, {100}, {0.0})[0];
  EXPECT_EQ(does_not.positions, 3U);
}

// Positions at 0, 1, 4 m with g = 0.8, 0.3, 0.5; the truth at 0 m, where g(s) = 0.6; global. By hand:
// E(1) = (0 + 1 * 0.3 + 4 * 0.5) / 1.6, E(0) = (0 + 1 * 0.7 + 4 * 0.5) / 1.4.
TEST(ErrorsInMap, TheSumByHand) {
  const FeatureMap map{
      .positions = {{0, 0}, {1, 0}, {4, 0}}, .vectors = 2, .probability = {0.2, 0.8, 0.7, 0.3, 0.5, 0.5}};
  const std::vector<double> p = {0.4, 0.6};
  const auto errors = ErrorsInMap(map, {0, 0}, p, {1, 0, 1}, {0.5, 1, 100});
  ASSERT_EQ(errors.size(), 3U);
  EXPECT_EQ(errors[0].positions, 1U);
  EXPECT_EQ(errors[0].prior_m, 0);
  EXPECT_EQ(errors[0].soft_m, 0);
  EXPECT_EQ(errors[1].positions, 2U);
  EXPECT_DOUBLE_EQ(errors[1].prior_m, 0.5);
  EXPECT_DOUBLE_EQ(errors[1].soft_m, 0.6 * (0.3 / 1.1) + 0.4 * (0.7 / 0.9));
  EXPECT_EQ(errors[2].positions, 3U);
  EXPECT_DOUBLE_EQ(errors[2].prior_m, 5.0 / 3);
  EXPECT_DOUBLE_EQ(errors[2].soft_m, 0.6 * (2.3 / 1.6) + 0.4 * (2.7 / 1.4));
  ASSERT_EQ(errors[2].sampled_m.size(), 3U);
  EXPECT_DOUBLE_EQ(errors[2].sampled_m[0], 2.3 / 1.6);
  EXPECT_DOUBLE_EQ(errors[2].sampled_m[1], 2.7 / 1.4);
  EXPECT_DOUBLE_EQ(errors[2].sampled_m[2], 2.3 / 1.6);
}

TEST(ErrorsInMap, AWindowWithoutPositionsHoldsNone) {
  const FeatureMap map{.positions = {{5, 0}}, .vectors = 2, .probability = {0.5, 0.5}};
  const auto errors = ErrorsInMap(map, {0, 0}, std::vector<double>{0.5, 0.5}, {0}, {1, 10});
  EXPECT_EQ(errors[0].positions, 0U);
  EXPECT_EQ(errors[1].positions, 1U);
}

// The map says that f = 1 cannot be; the robot senses it with 0.3. What is impossible tells nothing.
TEST(ErrorsInMap, AFeatureThatTheMapRulesOutLeavesTheBeliefAsItWas) {
  const FeatureMap map{.positions = {{0, 0}, {2, 0}}, .vectors = 2, .probability = {1, 0, 1, 0}};
  const auto errors = ErrorsInMap(map, {0, 0}, std::vector<double>{0.7, 0.3}, {1}, {10});
  EXPECT_DOUBLE_EQ(errors[0].soft_m, 1.0);
  EXPECT_DOUBLE_EQ(errors[0].sampled_m[0], 1.0);
}

// [Thr98] eq. 42 as it is printed, but for the map: three nested sums, normalised for each f anew.
double LiteralM(const FeatureMap& map, const Point& truth, const std::vector<double>& p, double window_m) {
  double sum = 0;
  for (std::size_t k = 0; k < map.positions.size(); ++k) {
    const double e = std::hypot(map.positions[k].x_m - truth.x_m, map.positions[k].y_m - truth.y_m);
    if (e > window_m) continue;
    for (std::size_t f = 0; f < map.vectors; ++f) {
      double all = 0;
      for (std::size_t j = 0; j < map.positions.size(); ++j) {
        const Point& other = map.positions[j];
        if (std::hypot(other.x_m - truth.x_m, other.y_m - truth.y_m) <= window_m)
          all += map.probability[j * map.vectors + f];
      }
      sum += e * p[f] * map.probability[k * map.vectors + f] / all;
    }
  }
  return sum;
}

TEST(ErrorsInMap, EqualsTheLiteralSumInRandomWorlds) {
  Rng rng(3);
  int compared = 0;
  for (int world = 0; world < 20; ++world) {
    std::vector<Point> positions;
    std::vector<double> g;
    for (int k = 0; k < 30; ++k) {
      positions.push_back({rng.Uniform(0, 20), rng.Uniform(0, 5)});
      for (int i = 0; i < 3; ++i) g.push_back(rng.Uniform());
    }
    const FeatureMap map = MapByNearest(positions, g, 3, 4);
    const Point truth{rng.Uniform(0, 20), rng.Uniform(0, 5)};
    const auto p = FeatureProbabilities(std::vector<double>{rng.Uniform(), rng.Uniform(), rng.Uniform()});
    const std::vector<double> windows_m = {2, 5, 100};
    const auto errors = ErrorsInMap(map, truth, p, {}, windows_m);
    for (std::size_t w = 0; w < windows_m.size(); ++w) {
      if (errors[w].positions == 0) continue;
      const double literal = LiteralM(map, truth, p, windows_m[w]);
      EXPECT_NEAR(errors[w].soft_m, literal, 1e-12 * literal);
      ++compared;
    }
  }
  EXPECT_GT(compared, 40);
}

}  // namespace
}  // namespace cairn::datasets
