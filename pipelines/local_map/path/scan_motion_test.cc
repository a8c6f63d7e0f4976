#include "pipelines/local_map/path/scan_motion.h"

#include <gtest/gtest.h>

#include "pipelines/local_map/testing/corridor.h"

namespace cairn::local_map {
namespace {

constexpr double kExplained = 0.8;

class ScanMotionTest : public testing::Test {
 protected:
  LaserView Seen(const Pose& robot) {
    ranges_ = LaserScan(NichedCorridor(), robot, rng_);
    return fan_.View({.time_s = 0, .turret_rad = 0, .range_m = ranges_});
  }

  Rng rng_{3};
  std::vector<double> ranges_;
  LaserFan fan_{LaserBeams(), 10};
};

TEST_F(ScanMotionTest, WhatOdometryTellsRightlyExplainsTheScans) {
  const Pose from{-2, 0, 0.1}, to{-1.4, 0.1, 0.4};
  const ScanMotion near = NearOdometry(Seen(from), Seen(to), Between(from, to), kExplained);
  EXPECT_GT(near.share, 0.9);
  EXPECT_GT(near.tells, 30);
}

TEST_F(ScanMotionTest, AClockThatIsOffALittleIsNoOtherMotion) {
  const Pose from{-2, 0, 0.1}, to{-1.8, 0, 0.4};
  Pose odometry = Between(from, to);
  odometry.heading_rad -= RadOf(6);
  EXPECT_GT(NearOdometry(Seen(from), Seen(to), odometry, kExplained).share, kExplained);
}

TEST_F(ScanMotionTest, ATurnThatOdometryMissesIsFound) {
  const Pose from{-2, 0, 0}, to{-1.9, 0, RadOf(38)};
  const LaserView before = Seen(from), after = Seen(to);
  EXPECT_LT(NearOdometry(before, after, {0.1, 0, 0}, kExplained).share, 0.6);
  const ScanMotion any = AnyMotion(before, after, {0.1, 0, 0}, RadOf(60), 0.4);
  EXPECT_GT(any.share, 0.9);
  EXPECT_NEAR(DegOf(any.moved.heading_rad), 38, 3);
  EXPECT_NEAR(any.moved.x_m, 0.1, 0.15);
}

TEST_F(ScanMotionTest, AWayThatOdometryMissesIsFound) {
  const Pose from{1, 0, 0}, to{1.6, 0, 0};
  const LaserView before = Seen(from), after = Seen(to);
  EXPECT_LT(NearOdometry(before, after, {}, kExplained).share, 0.8);
  const ScanMotion any = AnyMotion(before, after, {}, RadOf(60), 0.8);
  EXPECT_GT(any.share, 0.9);
  EXPECT_NEAR(any.moved.x_m, 0.6, 0.15);
  EXPECT_NEAR(any.moved.heading_rad, 0, 0.05);
}

}  // namespace
}  // namespace cairn::local_map
