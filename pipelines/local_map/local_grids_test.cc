#include "pipelines/local_map/local_grids.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pipelines/local_map/testing_room.h"
#include "schema/error.h"

namespace cairn::local_map {
namespace {

// A robot that drives in a circle in a room, its turret swinging.
struct Circle {
  std::vector<TestWall> walls;
  Rng rng{7};
  double radius_m = 0.8;
  std::vector<double> ranges = {};

  Pose PoseAt(int sweep) const {
    const double angle = 0.05 * sweep;
    return {radius_m * std::cos(angle), radius_m * std::sin(angle), angle + std::numbers::pi / 2};
  }
  RingSweep Sweep(int sweep) {
    const double turret = 0.8 * std::sin(0.2 * sweep);
    ranges = SonarSweep(walls, PoseAt(sweep), turret, rng);
    return {0.2 * sweep, turret, ranges};
  }
};

TEST(LocalGrids, LocksOntoTheWallsOfARoom) {
  for (const double turned_deg : {0.0, 17.0, -38.0}) {
    Circle drive{TestBox(6, 4, {0, 0, RadOf(turned_deg)})};
    LocalGrids grids({}, {SensorRing(RingBeams(), 0.2618, 6)});
    int locks = 0, judged = 0, right = 0;
    for (int k = 0; k < 200; ++k) {
      const RingSweep sweep = drive.Sweep(k);
      locks += grids.Update(drive.PoseAt(k), std::span(&sweep, 1)) == Alignment::kLocked;
      if (!grids.walls_rad()) continue;
      ++judged;
      const double off =
          ModuloAngle(grids.walls_rad()->angle_rad - RadOf(turned_deg), WallOrientation::kPeriodRad);
      right += std::abs(DegOf(off)) < 2;
    }
    EXPECT_EQ(locks, 1);
    EXPECT_GT(judged, 150);
    EXPECT_GE(right, judged * 95 / 100) << turned_deg;
    EXPECT_GE(grids.current_edges().size(), 1U);
  }
}

TEST(LocalGrids, BadInputIsNamed) {
  LocalGrids grids({}, {SensorRing(RingBeams(), 0.2618, 6)});
  std::vector<double> ranges(24, 1.0), few(3, 1.0);
  RingSweep sweep{0, 0, ranges};
  EXPECT_THROW(grids.Update({std::nan(""), 0, 0}, std::span(&sweep, 1)), InputError);
  EXPECT_THROW(grids.Update({1e9, 0, 0}, std::span(&sweep, 1)), InputError);
  EXPECT_THROW(grids.Update({0, 0, 0}, {}), InputError);
  sweep.range_m = few;
  EXPECT_THROW(grids.Update({0, 0, 0}, std::span(&sweep, 1)), InputError);
}

}  // namespace
}  // namespace cairn::local_map
