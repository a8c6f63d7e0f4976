#include "pipelines/landmark_map/summary.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace cairn::landmark_map {
namespace {

TEST(Summarise, GivesMeanCovarianceAndModeAcrossTheWrap) {
  const GridSpec grid{0.5, 8};
  LayeredGrid belief;
  belief.layers.resize(8);
  for (const int c : {0, 7}) {  // 0 and -45 degrees
    belief.layers[c] = Layer(Box{2, 4, 2, 1});
    belief.layers[c].values = {0.1, c == 0 ? 0.5 : 0.3};
  }
  const PoseSummary pose = Summarise(belief, grid);
  EXPECT_NEAR(pose.x_m, (2 * 0.2 + 3 * 0.8) * 0.5, 1e-12);
  EXPECT_NEAR(pose.y_m, 2.0, 1e-12);
  EXPECT_LT(pose.heading_rad, 0.0);
  EXPECT_GT(pose.heading_rad, -std::numbers::pi / 4);
  EXPECT_NEAR(pose.covariance[0], 0.2 * 0.8 * 0.25, 1e-12);
  EXPECT_NEAR(pose.covariance[4], 0.0, 1e-12);
  EXPECT_NEAR(pose.mode_y_m, 2.0, 1e-12);
  EXPECT_GT(pose.mode_x_m, 1.25);
}

LayeredGrid Counts(const std::vector<std::array<double, 3>>& points) {
  LayeredGrid counts;
  counts.layers.emplace_back(Box{-20, -20, 60, 60});
  for (const auto& [x, y, c] : points) counts.layers[0].Row(static_cast<int>(y))[static_cast<int>(x)] += c;
  return counts;
}

TEST(ExtractLandmarks, JoinsACoreAndDropsWhatIsLessThanHalfAnObservation) {
  MapRules rules;
  rules.grid = {1.0, 4};
  rules.core_m = 2.5;
  const std::vector<Landmark> landmarks =
      ExtractLandmarks(Counts({{0, 0, 2}, {1, 0, 2}, {20, 3, 1.0}, {30, 30, 0.4}}), rules);
  ASSERT_EQ(landmarks.size(), 2U);
  EXPECT_NEAR(landmarks[0].x_m, 0.5, 1e-12);
  EXPECT_NEAR(landmarks[0].count, 4.0, 1e-12);
  EXPECT_NEAR(landmarks[0].covariance_m2[0], 0.25 + 1.0 / 12, 1e-12);
  EXPECT_NEAR(landmarks[1].x_m, 20.0, 1e-12);
}

// A single cell of 0.45 stands higher than 0.7 spread over a disc, but it is no landmark; the disc is.
TEST(ExtractLandmarks, ANarrowPeakThatIsNoLandmarkHidesNoOther) {
  MapRules rules;
  rules.grid = {1.0, 4};
  rules.core_m = 2.5;
  std::vector<std::array<double, 3>> points = {{30, 30, 0.45}};
  for (int y = -2; y <= 2; ++y) {
    for (int x = -2; x <= 2; ++x) {
      if (x * x + y * y <= 4) points.push_back({double(x), double(y), 0.7 / 13});
    }
  }
  const std::vector<Landmark> landmarks = ExtractLandmarks(Counts(points), rules);
  ASSERT_EQ(landmarks.size(), 1U);
  EXPECT_NEAR(landmarks[0].count, 0.7, 1e-9);
}

TEST(Associate, TakesTheNearestLandmarkOfTheTypeWithinReach) {
  const std::vector<Landmark> landmarks = {{0, 0, {}, 0, 1}, {4, 0, {}, 0, 1}, {4, 0.5, {}, 1, 1}};
  Layer where(Box{0, 0, 6, 1});
  where.values = {0.1, 0.2, 0.0, 0.3, 0.4, 0.0};
  const Association a = Associate(where, 0, landmarks, 1.0, 3.0);
  EXPECT_EQ(a.landmark, 1);
  EXPECT_NEAR(a.probability, 0.7, 1e-12);
  Layer far(Box{30, 0, 1, 1});
  far.values = {1.0};
  EXPECT_EQ(Associate(far, 0, landmarks, 1.0, 3.0).landmark, -1);
}

}  // namespace
}  // namespace cairn::landmark_map
