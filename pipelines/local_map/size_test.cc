#include "pipelines/local_map/size.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "pipelines/common/state_scalars.h"

namespace cairn::local_map {
namespace {

constexpr std::size_t kLaserBeams = 40, kScans = 200;
constexpr double kStep_m = 0.5, kUnanswered = std::numeric_limits<double>::quiet_NaN();

// A robot whose laser, half a metre after half a metre, meets walls at `far_m` with 30 beams, with nothing
// with 6, and with 4, a tenth of all, at 2 m where `sees(scan)`.
struct Drive40 {
  PosedScans scans;
  std::vector<RobotRuns> robots;
};
template <class Sees>
Drive40 DriveOf(double far_m, const Sees& sees) {
  Drive40 drive;
  RangeScans laser;
  for (std::size_t b = 0; b < kLaserBeams; ++b)
    laser.beams.push_back({0, 0, std::numbers::pi * (static_cast<double>(b) / kLaserBeams - 0.5)});
  laser.max_range_m = 100;
  RobotRuns robot;
  robot.sensors = {0};
  std::vector<double> ranges;
  for (std::size_t s = 0; s < kScans; ++s) {
    for (std::size_t b = 0; b < kLaserBeams; ++b)
      ranges.push_back(b < 30 ? far_m : b < 36 ? kUnanswered : sees(s) ? 2 : far_m);
    Scan scan;
    scan.time_s = static_cast<double>(s);
    scan.path_m = kStep_m * static_cast<double>(s);
    robot.scans.push_back(scan);
    robot.row_of_log.push_back(static_cast<std::int64_t>(s));
  }
  laser.range_m = Array::Of<double>({kScans, kLaserBeams}, ranges);
  drive.scans.sensors = {laser};
  drive.robots = {robot};
  return drive;
}

Size Chosen(const Drive40& drive, const Options& options = {}) {
  return ChooseSize(options, drive.scans, drive.robots);
}

bool IsHall(const Size& size) { return size.cell_m == kHall.cell_m; }

const auto kNever = [](std::size_t) { return false; };

TEST(Size, AHallTakesWhatReachesItsWalls) {
  const Size size = Chosen(DriveOf(9.5, kNever));
  EXPECT_EQ(size.cell_m, 0.3);
  EXPECT_EQ(size.half_cells, 32);  // 9.6 m
  EXPECT_EQ(size.ring_beams, 180);
  EXPECT_EQ(Chosen(DriveOf(80, kNever)).half_cells, 60);
  EXPECT_EQ(Chosen(DriveOf(2.4, kNever)).half_cells, 15);
}

TEST(Size, WhereTheDefaultSeesEnoughItStays) {
  const Size size = Chosen(DriveOf(9.5, [](std::size_t) { return true; }));
  EXPECT_EQ(size.cell_m, 0.15);
  EXPECT_EQ(size.half_cells, 15);
  EXPECT_EQ(size.ring_beams, 72);
}

// 99.5 m of way: 15% of it are 30 scans.
TEST(Size, AHallIsMoreThanFifteenPercentOfTheWay) {
  EXPECT_FALSE(IsHall(Chosen(DriveOf(9.5, [](std::size_t s) { return s >= 30; }))));
  EXPECT_TRUE(IsHall(Chosen(DriveOf(9.5, [](std::size_t s) { return s >= 32; }))));
}

// The open middles of rooms: 4 m at a time. A person who passes does not end a hall.
TEST(Size, AHallIsOpenForMoreThanFiveMetres) {
  EXPECT_FALSE(IsHall(Chosen(DriveOf(9.5, [](std::size_t s) { return s % 12 >= 8; }))));
  EXPECT_TRUE(IsHall(Chosen(DriveOf(9.5, [](std::size_t s) { return s % 12 >= 11; }))));
}

TEST(Size, ARobotThatStandsInAHallDoesNotDriveThroughIt) {
  Drive40 drive = DriveOf(9.5, [](std::size_t s) { return s >= 100; });
  for (Scan& scan : drive.robots[0].scans) scan.path_m = std::max(0.0, scan.path_m - 50);
  EXPECT_FALSE(IsHall(Chosen(drive)));
}

// Sonar is no witness: it hears walls far off as arcs.
TEST(Size, SonarTakesTheDefault) {
  Drive40 drive = DriveOf(4, kNever);
  drive.scans.sensors[0].opening_rad = 0.3;
  EXPECT_FALSE(IsHall(Chosen(drive)));
}

// Rays, as a laser's, which end at 0.8 m.
TEST(Size, InfraRedIsNoWitnessEither) {
  std::vector<double> ranges(kScans * kLaserBeams, kUnanswered);
  for (std::size_t k = 0; k < ranges.size(); k += kLaserBeams) ranges[k] = 0.5;
  Drive40 drive = DriveOf(4, kNever);
  drive.scans.sensors[0].range_m = Array::Of<double>({kScans, kLaserBeams}, ranges);
  EXPECT_TRUE(IsHall(Chosen(drive))) << "a laser's";
  drive.scans.sensors[0].max_range_m = 0.8;
  EXPECT_FALSE(IsHall(Chosen(drive)));
}

// Of 60 beams, a degree apart, every third answers, and a tenth of these meet something near.
TEST(Size, BeamsThatAreLostMakeNoHall) {
  Drive40 drive = DriveOf(9.5, kNever);
  RangeScans& laser = drive.scans.sensors[0];
  laser.beams.clear();
  for (int b = 0; b < 60; ++b) laser.beams.push_back({0, 0, b * std::numbers::pi / 180});
  std::vector<double> ranges;
  for (std::size_t k = 0; k < kScans * 60; ++k)
    ranges.push_back(k % 3 != 0 ? kUnanswered : k % 60 >= 54 ? 2 : 9.5);
  laser.range_m = Array::Of<double>({kScans, 60}, ranges);
  EXPECT_FALSE(IsHall(Chosen(drive)));
}

TEST(Size, OneRobotInAHallIsEnough) {
  Drive40 drive = DriveOf(9.5, [](std::size_t) { return true; });
  const Drive40 other = DriveOf(9.5, kNever);
  drive.scans.sensors.push_back(other.scans.sensors[0]);
  drive.robots.push_back(other.robots[0]);
  drive.robots[1].sensors = {1};
  EXPECT_TRUE(IsHall(Chosen(drive)));
}

TEST(Size, WhatIsGivenIsTaken) {
  const Drive40 hall = DriveOf(9.5, kNever);
  Options options;
  options.grid.half_cells = 80;
  EXPECT_EQ(Chosen(hall, options).half_cells, 80);
  EXPECT_EQ(Chosen(hall, options).cell_m, 0.3);
  EXPECT_EQ(Chosen(hall, options).ring_beams, 180);
  options.grid = Options().grid;
  options.grid.cell_m = 0.5;
  options.ring_beams = 90;
  EXPECT_EQ(Chosen(hall, options).half_cells, 19);
  EXPECT_EQ(Chosen(hall, options).cell_m, 0.5);
  EXPECT_EQ(Chosen(hall, options).ring_beams, 90);
}

TEST(Size, WhatNoGridCanHaveIsRefused) {
  const Drive40 drive = DriveOf(9.5, kNever);
  Options options;
  options.grid.half_cells = 1;
  EXPECT_THROW(Chosen(drive, options), InputError);
  options.grid = Options().grid;
  options.grid.cell_m = 0.001;
  EXPECT_THROW(Chosen(drive, options), InputError);
  options.grid = Options().grid;
  options.ring_beams = 7;
  EXPECT_THROW(Chosen(drive, options), InputError);
}

TEST(Size, TasksHaveTheStatesAndNoOther) {
  proto::Step plan;
  PutScalars(Size{0.25, 40, 100}, "", plan.mutable_state());
  TaskBuilder builder("walls", 1, &plan);
  EXPECT_THROW(SizeOf(plan.tasks(0)), InputError);
  SetSize(plan.state(), &builder);
  const Size size = SizeOf(plan.tasks(0));
  EXPECT_EQ(size.cell_m, 0.25);
  EXPECT_EQ(size.half_cells, 40);
  EXPECT_EQ(size.ring_beams, 100);
  builder.Set("half_cells", 1000);
  EXPECT_THROW(SizeOf(plan.tasks(0)), InputError);
}

}  // namespace
}  // namespace cairn::local_map
