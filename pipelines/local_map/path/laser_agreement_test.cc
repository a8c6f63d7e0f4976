#include "pipelines/local_map/path/laser_agreement.h"

#include <gtest/gtest.h>

#include "pipelines/local_map/testing/two_lasers.h"

namespace cairn::local_map {
namespace {

constexpr double kTurned = std::numbers::pi;
const TestLaser kAhead{.mount = {0.2, 0, 0}, .told = {0.2, 0, 0}};

TestLaser Behind(const Pose& told) { return {.mount = {-0.2, 0, kTurned}, .told = told}; }

// `metre`: of odometry, along which the scans are.
std::vector<LaserAgreement> Compared(const TwoLaserDrive& drive, double metre = 1) {
  std::vector<ScaleWatch::Ring> rings;
  for (const TestLaser& laser : drive.lasers) rings.push_back({laser.Beams(laser.told), 0, 10});
  std::vector<Scan> path;
  Pose pose;
  double path_m = 0;
  for (const Pose& step : drive.steps) {
    pose = Compose(pose, {metre * step.x_m, 0, step.heading_rad});
    path_m += metre * step.x_m;
    path.push_back({.pose = pose, .path_m = path_m});
  }
  std::vector<RingScan> read(drive.lasers.size());
  return CompareLasers(
      rings, path,
      [&](std::size_t scan) {
        for (std::size_t k = 0; k < read.size(); ++k)
          read[k].range_m =
              std::span(drive.lasers[k].range_m).subspan(scan * TestLaser::kBeams, TestLaser::kBeams);
        return std::span<const RingScan>(read);
      },
      [] {});
}

TEST(LaserAgreement, LasersOfRightMountsMeetTheSameWalls) {
  const auto all = Compared({{kAhead, Behind({-0.2, 0, kTurned})}, FurnishedRoom(), 8});
  ASSERT_EQ(all.size(), 1U);
  EXPECT_GT(all[0].looked, 1000);
  EXPECT_GT(all[0].share, 0.93);
  EXPECT_LT(all[0].moved_m, 0.06);
  EXPECT_LT(all[0].moved_rad, RadOf(1));
}

TEST(LaserAgreement, HowFarAMountIsOffIsFound) {
  for (const Pose& off : {Pose{0.6, 0, 0}, Pose{0, 0, RadOf(11)}, Pose{0, 0.3, RadOf(-20)},
                          Pose{0, 0, RadOf(90)}, Pose{0.4, 0, kTurned}}) {
    const auto all = Compared(
        {{kAhead, Behind({-0.2 + off.x_m, off.y_m, kTurned + off.heading_rad})}, FurnishedRoom(), 8});
    ASSERT_EQ(all.size(), 1U);
    EXPECT_LT(all[0].share, 0.75) << off.x_m << ' ' << off.heading_rad;
    EXPECT_GT(all[0].moved_share, 0.93);
    EXPECT_NEAR(all[0].moved_m, std::hypot(off.x_m, off.y_m), 0.1);
    EXPECT_NEAR(all[0].moved_rad, std::abs(off.heading_rad), RadOf(2));
  }
}

TEST(LaserAgreement, LasersThatNeverLookAtTheSamePlaceTellNothing) {
  const TestLaser left{.mount = {0, 0.2, kTurned / 2}, .told = {0, 0.2, kTurned / 2}, .view_rad = 1};
  const TestLaser right{.mount = {0, -0.2, -kTurned / 2}, .told = {0, -0.2, -kTurned / 2}, .view_rad = 1};
  const auto all = Compared({{left, right}, FurnishedRoom(), 1, false});
  EXPECT_TRUE(all.empty());
}

// They see the walls of the room in turn, and the walls of a room are alike.
TEST(LaserAgreement, LasersToEitherSideAreHeldAgainstEachOther) {
  const TestLaser left{
      .mount = {0, 0.2, kTurned / 2}, .told = {0, 0.2, kTurned / 2}, .view_rad = kTurned / 2};
  for (const double off_deg : {0.0, 20.0}) {
    const TestLaser right{.mount = {0, -0.2, -kTurned / 2},
                          .told = {0, -0.2, -kTurned / 2 + RadOf(off_deg)},
                          .view_rad = kTurned / 2};
    const auto all = Compared({{left, right}, FurnishedRoom(), 8});
    ASSERT_EQ(all.size(), 1U);
    EXPECT_EQ(all[0].share > 0.9, off_deg == 0) << all[0].share;
    EXPECT_GT(all[0].moved_share, 0.9);
    EXPECT_NEAR(all[0].moved_rad, RadOf(off_deg), RadOf(10)) << "they seldom look at the same places";
  }
}

// The legs of tables, and what hangs over them.
TEST(LaserAgreement, WhatOneAloneSeesIsExplainedByNoMount) {
  TestLaser low = Behind({-0.2, 0, kTurned});
  for (int k = 0; k < 4; ++k)
    for (const TestWall& wall : TestBox(0.3, 1.2, Compose({0, 0, k * kTurned / 2}, {2.6, 0.4 * k - 0.6, 0})))
      low.walls.push_back(wall);
  const auto all = Compared({{kAhead, low}, FurnishedRoom(), 8});
  ASSERT_EQ(all.size(), 1U);
  EXPECT_LT(all[0].share, 0.75);
  EXPECT_LT(all[0].moved_m, 0.1);
  EXPECT_LT(all[0].moved_rad, RadOf(3));
}

TEST(LaserAgreement, AMetreOfOdometryThatIsNotOneIsNoMountsFault) {
  for (const double metre : {0.93, 1.07}) {
    const auto all = Compared({{kAhead, Behind({-0.2, 0, kTurned})}, FurnishedRoom(), 8}, metre);
    ASSERT_EQ(all.size(), 1U);
    EXPECT_GT(all[0].share, 0.75);
    EXPECT_LT(all[0].moved_m, 0.15);
  }
}

TEST(LaserAgreement, OneLaserAndARingOfSonarsAreNotCompared) {
  TwoLaserDrive drive({kAhead, Behind({0.4, 0, kTurned})}, FurnishedRoom(), 1);
  std::vector<ScaleWatch::Ring> rings{{kAhead.Beams(kAhead.told), 0, 10}, {RingBeams(), kTestOpeningRad, 6}};
  EXPECT_TRUE(
      CompareLasers(rings, {}, [](std::size_t) { return std::span<const RingScan>(); }, [] {}).empty());
}

}  // namespace
}  // namespace cairn::local_map
