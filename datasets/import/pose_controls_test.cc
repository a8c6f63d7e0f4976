#include "datasets/import/pose_controls.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "datasets/common/control.h"
#include "schema/rng.h"

namespace cairn::datasets {
namespace {

constexpr double kPiOfPoses = std::numbers::pi;

// Where dead reckoning is after all controls up to `time_s`.
Pose Reckon(const Odometry& odometry, const Pose& start, double time_s) {
  Pose pose = start;
  for (std::size_t i = 0; i < odometry.time_s.size() && odometry.time_s[i] <= time_s; ++i)
    pose = Apply(pose, {odometry.turn_rad[i], odometry.forward_m[i]});
  return pose;
}

TEST(ControlsOf, AnArcIsHalfATurnAWayAndHalfATurn) {
  const double half = 0.1, chord = 2 * 5 * std::sin(half);
  const Odometry odometry =
      ControlsOf({{1, {0, 0, 0}}, {2, {chord * std::cos(half), chord * std::sin(half), 2 * half}}});
  EXPECT_EQ(odometry.time_s.vector(), (std::vector<double>{1, 2, 2}));
  EXPECT_NEAR(odometry.turn_rad[1], half, 1e-12);
  EXPECT_NEAR(odometry.forward_m[1], chord, 1e-12);
  EXPECT_NEAR(odometry.turn_rad[2], half, 1e-12);
}

TEST(ControlsOf, ARobotThatBacksUpDoesNotTurnRound) {
  const Odometry odometry = ControlsOf({{0, {0, 0, 0}}, {1, {-1, 0, 0}}, {2, {-1.5, 0.5, -kPiOfPoses / 2}}});
  EXPECT_NEAR(odometry.forward_m[1], -1, 1e-12);
  EXPECT_EQ(odometry.turn_rad[1], 0);
  EXPECT_NEAR(odometry.forward_m[2], -std::hypot(0.5, 0.5), 1e-12);
  EXPECT_NEAR(odometry.turn_rad[2], -kPiOfPoses / 4, 1e-12);
}

TEST(ControlsOf, ReckoningStaysByThePosesHoweverJittery) {
  Rng rng(7, 0, 0);
  std::vector<TimedPose> poses{{0, {3, -2, 1}}};
  for (int i = 1; i < 3000; ++i) {
    Pose pose = poses.back().pose;
    const int phase = i / 100 % 4;  // drives, turns in place, backs up, is carried aside
    if (phase == 0) pose = Apply(pose, {0.03 * rng.Normal(), 0.05});
    if (phase == 1) pose.heading_rad = WrapAngle(pose.heading_rad + 0.1);
    if (phase == 2) pose = Apply(pose, {0.01, -0.02});
    if (phase == 3) pose.y_m += 0.01;
    pose.x_m += 1e-4 * rng.Normal();
    pose.y_m += 1e-4 * rng.Normal();
    poses.push_back({0.1 * i, pose});
  }
  const Odometry odometry = ControlsOf(poses);
  double turned = 0;
  for (std::size_t i = 0; i < odometry.turn_rad.size(); ++i) turned += std::abs(odometry.turn_rad[i]);
  for (std::size_t i = 0; i < poses.size(); i += 10) {
    const Pose at = Reckon(odometry, poses[0].pose, poses[i].time_s);
    EXPECT_LE(std::hypot(at.x_m - poses[i].pose.x_m, at.y_m - poses[i].pose.y_m),
              std::sqrt(2) * kMostAsideM + 1e-9)
        << i;
    EXPECT_NEAR(WrapAngle(at.heading_rad - poses[i].pose.heading_rad), 0, 1e-9) << i;
  }
  // In place 800 poses turn by 0.1, jitter adds none; sideways it has to turn there and back.
  EXPECT_LT(turned, 800 * 0.1 + 800 * 0.05 + 800 * 0.02 + 400 * kPiOfPoses);
}

TEST(ControlsOf, AHaltHasItsEndOnly) {
  const Pose here{1, 1, 0};
  const Odometry odometry = ControlsOf({{0, here}, {1, here}, {2, here}, {3, {2, 1, 0}}, {4, {2, 1, 0}}});
  EXPECT_EQ(odometry.time_s.vector(), (std::vector<double>{0, 2, 3, 4}));
  EXPECT_EQ(odometry.forward_m.vector(), (std::vector<double>{0, 0, 1, 0}));
  EXPECT_TRUE(ControlsOf(std::vector<TimedPose>()).time_s.empty());
}

}  // namespace
}  // namespace cairn::datasets
