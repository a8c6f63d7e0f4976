#include "pipelines/common/pose_track.h"

#include <gtest/gtest.h>

#include <cmath>

#include "schema/error.h"
#include "schema/kinds/kind.h"

namespace cairn {
namespace {

using Column = std::vector<double>;

// Turns left by 1 rad in the second of four motion increments of 1 m, one a second.
Blob LogWithOdometry() {
  Blob log;
  log.Put("robots", Array::Texts({"ann"}));
  log.PutVector<double>("robot/0/odometry/time_s", {1, 2, 3, 4});
  log.PutVector<double>("robot/0/odometry/turn_rad", {0, 1, 0, 0});
  log.PutVector<double>("robot/0/odometry/forward_m", {1, 1, 1, 1});
  return log;
}

void PutPoses(const std::string& prefix, const Column& time, const Column& x, const Column& y,
              const Column& heading, Blob* blob) {
  blob->PutVector(prefix + "time_s", time);
  blob->PutVector(prefix + "x_m", x);
  blob->PutVector(prefix + "y_m", y);
  blob->PutVector(prefix + "heading_rad", heading);
}

void ExpectPose(const std::optional<Pose>& pose, const Pose& expected) {
  ASSERT_TRUE(pose.has_value());
  EXPECT_NEAR(pose->x_m, expected.x_m, 1e-12);
  EXPECT_NEAR(pose->y_m, expected.y_m, 1e-12);
  EXPECT_NEAR(WrapAngle(pose->heading_rad - expected.heading_rad), 0, 1e-12);
}

TEST(PoseTrack, WithoutPosesIsDeadReckoning) {
  const Blob log = LogWithOdometry();
  ExpectPose(PoseTrack::Of(log, nullptr, 0, 0).At(1), {1, 0, 0});
  ExpectPose(PoseTrack::Of(log, nullptr, 0, 0).At(2.5), {1 + 1.5 * std::cos(1), 1.5 * std::sin(1), 1});
}

TEST(PoseTrack, BetweenPosesMovesAsOdometryDoesAndSpreadsTheRest) {
  Blob log = LogWithOdometry();
  // The same way but turned by 0.5 rad, and 0.3 m further on at the end than odometry says.
  const double c = std::cos(1.5), s = std::sin(1.5);
  const Pose start{1 * std::cos(0.5), 1 * std::sin(0.5), 0.5};
  PutPoses("robot/0/poses/", {1, 3}, {start.x_m, start.x_m + 2.3 * c}, {start.y_m, start.y_m + 2.3 * s},
           {0.5, 1.5}, &log);
  const PoseTrack track = PoseTrack::Of(log, nullptr, 0, 0);
  ExpectPose(track.At(1), start);
  ExpectPose(track.At(2),
             {start.x_m + 1.15 * c, start.y_m + 1.15 * s, 1.5});  // not on the straight line of turns
  EXPECT_FALSE(track.At(0.9).has_value());
  EXPECT_FALSE(track.At(3.1).has_value());
}

TEST(PoseTrack, WithoutOdometryGoesStraightAndTurnsTheShortWay) {
  Blob log;
  log.Put("robots", Array::Texts({"ann"}));
  PutPoses("robot/0/poses/", {0, 10}, {0, 2}, {0, 4}, {3, -3}, &log);
  ExpectPose(PoseTrack::Of(log, nullptr, 0, 0).At(5), {1, 2, 3.14159265358979323846});
  EXPECT_FALSE(PoseTrack::Of(log, nullptr, 0, 9).At(5).has_value()) << "in a gap";
  EXPECT_TRUE(PoseTrack::Of(log, nullptr, 0, 9).At(10).has_value());
}

TEST(PoseTrack, PosesGivenComeBeforeTheLogsOwnAndGoByName) {
  Blob log = LogWithOdometry();
  PutPoses("robot/0/poses/", {1, 4}, {0, 0}, {0, 0}, {0, 0}, &log);
  Blob poses;
  poses.Put("robots", Array::Texts({"bob", "ann"}));
  PutPoses("robot/0/poses/", {1}, {9}, {9}, {0}, &poses);
  PutPoses("robot/1/poses/", {1}, {7}, {8}, {0}, &poses);
  ExpectPose(PoseTrack::Of(log, &poses, 0, 0).At(1), {7, 8, 0});
}

TEST(PoseTrack, DeadReckoningAndLocalMapsHaveAFrameOfEachRobotsOwn) {
  Blob log = LogWithOdometry();
  EXPECT_TRUE(PoseTrack::Of(log, nullptr, 0, 0).has_own_frame());
  Blob poses;
  poses.Put("robots", Array::Texts({"ann"}));
  PutPoses("robot/0/poses/", {1}, {7}, {8}, {0}, &poses);
  EXPECT_FALSE(PoseTrack::Of(log, &poses, 0, 0).has_own_frame());
  poses.PutVector<std::int32_t>("traces/first_z", {});  // a local_map
  EXPECT_TRUE(PoseTrack::Of(log, &poses, 0, 0).has_own_frame());
  poses.PutVector<double>("map/landmark_x_m", {});  // a landmark_map
  EXPECT_FALSE(PoseTrack::Of(log, &poses, 0, 0).has_own_frame());
  PutPoses("robot/0/poses/", {1, 4}, {0, 0}, {0, 0}, {0, 0}, &log);
  EXPECT_FALSE(PoseTrack::Of(log, nullptr, 0, 0).has_own_frame());
}

TEST(PoseTrack, WhatCannotBeUsedIsNamed) {
  const auto refusal = [](const Blob& log, const Blob* poses) {
    try {
      CheckInput(log, "log");
      PoseTrack::Of(log, poses, 0, 0);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  Blob bare;
  bare.Put("robots", Array::Texts({"ann"}));
  EXPECT_NE(refusal(bare, nullptr).find("neither poses nor odometry"), std::string::npos);
  Blob others;
  others.Put("robots", Array::Texts({"bob"}));
  EXPECT_NE(refusal(LogWithOdometry(), &others).find("no poses of robot 'ann'; the table has poses of 'bob'"),
            std::string::npos);
  Blob back = bare;
  PutPoses("robot/0/poses/", {1, 0}, {0, 0}, {0, 0}, {0, 0}, &back);
  EXPECT_NE(refusal(back, nullptr).find("'robot/0/poses/time_s', entry 1"), std::string::npos);
  Blob nan = bare;
  PutPoses("robot/0/poses/", {1}, {std::nan("")}, {0}, {0}, &nan);
  EXPECT_NE(refusal(nan, nullptr).find("'robot/0/poses/x_m': nan"), std::string::npos);
}

}  // namespace
}  // namespace cairn
