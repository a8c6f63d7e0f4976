#include "pipelines/common/odometry.h"

#include <gtest/gtest.h>

#include <numbers>
#include <vector>

namespace cairn {
namespace {

constexpr double kQuarter = std::numbers::pi / 2;

Odometry Reckoned(const std::vector<double>& time_s, const std::vector<double>& turn_rad,
                  const std::vector<double>& forward_m) {
  return Integrate({Column<double>(time_s), Column<double>(turn_rad), Column<double>(forward_m)}, "rover");
}

// A log tells of a robot that faces ahead and goes to its left as of a turn to the left, a way and a turn
// back.
TEST(Odometry, ARobotThatGoesAsideHasNotTurned) {
  const Odometry odometry = Reckoned(
      {0, 1, 1, 2, 2, 3}, {0, kQuarter, -kQuarter, kQuarter + 0.1, -kQuarter, 0.2}, {0, 2, 0, 2, 0, 1});
  EXPECT_NEAR(odometry.turn_rad.back(), 0.3, 1e-12);
  EXPECT_NEAR(odometry.heading_rad.back(), 0.3, 1e-12);
  const OdometricPose half = PoseAt(odometry, 0.5);
  EXPECT_NEAR(half.x_m, 0.0, 1e-12);
  EXPECT_NEAR(half.y_m, 1.0, 1e-12);
  EXPECT_NEAR(half.heading_rad, 0.0, 1e-12) << "not where it goes";
  EXPECT_NEAR(PoseAt(odometry, 1.5).heading_rad, 0.05, 1e-12);
  EXPECT_NEAR(PoseAtPath(odometry, 3.0).turn_rad, 0.05, 1e-12);
  EXPECT_NEAR(odometry.aside_rad[2], kQuarter, 1e-12);
}

// The halves of an arc's turn, a swing of a robot that cannot go aside, a turn back at another time.
TEST(Odometry, OtherTurnsCountAsOften) {
  EXPECT_EQ(Reckoned({1, 1}, {0.4, 0.4}, {1, 0}).turn_rad.back(), 0.8);
  EXPECT_EQ(Reckoned({1, 1}, {0.05, -0.03}, {1, 0}).turn_rad.back(), 0.05 + 0.03);
  EXPECT_EQ(Reckoned({1, 2}, {0.4, -0.4}, {1, 0}).turn_rad.back(), 0.8);
  EXPECT_EQ(Reckoned({1, 1}, {0.4, -0.4}, {1, 1}).turn_rad.back(), 0.8) << "the second one has a way, too";
}

}  // namespace
}  // namespace cairn
