#include "pipelines/local_map/traces/immediate_trace.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pipelines/local_map/testing/drive.h"

namespace cairn::local_map {
namespace {

TEST(TraceFrame, CellsPointsAndDirectionsAgreeInAllFourDirections) {
  for (int quarter = 0; quarter < 4; ++quarter) {
    const TraceFrame frame{quarter, {7, -3}};
    const CellIndex cell = frame.CellAt(4, 2);
    const Position at = frame.At({cell.i * 0.15, cell.j * 0.15}, 0.15);
    EXPECT_NEAR(at.z_m, 0.6, 1e-12);
    EXPECT_NEAR(at.u_m, 0.3, 1e-12);
    const Point back = frame.Local({0.6, 0.3}, 0.15);
    EXPECT_NEAR(back.x_m, cell.i * 0.15, 1e-12);
    EXPECT_NEAR(back.y_m, cell.j * 0.15, 1e-12);
    EXPECT_NEAR(std::sin(frame.Direction(quarter * std::numbers::pi / 2)), 0, 1e-12);
  }
}

// A corridor 2 m wide; the robot is 0.3 m left of its middle. A cone hears an oblique wall a few centimetres
// too near.
TEST(ImmediateTrace, KnowsTheDistancesOfWallsToCentimetres) {
  Drive drive({{{-9, 1}, {9, 1}}, {{-9, -1}, {9, -1}}}, {-2, 0.3, 0}, 1);
  drive.Ahead(4);
  ImmediateTrace now = ImmediateRoom(drive.grids());
  MakeImmediate(drive.grids(), 0, now);
  int known = 0, occupied = 0;
  for (int z = -6; z <= 6; ++z) {
    const Feature& feature = *now.trace.Find(z);
    if (!feature.left.known() || !feature.right.known()) continue;
    ++known;
    EXPECT_NEAR(feature.left.distance_m.centre() - now.robot.u_m, 0.7, 0.12);
    EXPECT_NEAR(feature.right.distance_m.centre() + now.robot.u_m, 1.3, 0.12);
    EXPECT_NEAR(feature.left.angle_rad.centre(), 0, 0.1);
    occupied += feature.left.occupied;
  }
  EXPECT_GT(known, 8);
  EXPECT_GT(occupied, 4);
}

// The end wall of a room is an edge across the way.
TEST(ImmediateTrace, KnowsWhereEdgesAcrossTheWayLie) {
  Drive drive(TestBox(6, 3, {}), {-2, 0, 0}, 1);
  drive.Ahead(3.5);
  ImmediateTrace now = ImmediateRoom(drive.grids());
  MakeImmediate(drive.grids(), 0, now);
  int known = 0;
  for (int z = 7; z <= 15; ++z) {
    const Side& side = now.trace.Find(z)->left;
    if (std::isnan(side.cross_m)) continue;
    ++known;
    EXPECT_NEAR(z * 0.15 + side.cross_m - now.robot.z_m, 3 - drive.pose().x_m, 0.12);
  }
  EXPECT_GT(known, 0);
}

TEST(ImmediateTrace, IsTheSameSurroundingsInAllDirections) {
  Drive drive(TestBox(6, 3, {}), {-2, 0.2, 0}, 1);
  drive.Ahead(2);
  ImmediateTrace ahead = ImmediateRoom(drive.grids()), back = ImmediateRoom(drive.grids());
  MakeImmediate(drive.grids(), 0, ahead);
  MakeImmediate(drive.grids(), 2, back);
  EXPECT_NEAR(back.robot.z_m, -ahead.robot.z_m, 1e-12);
  const EdgeTrace turned = Reversed(ahead.trace);
  int known = 0;
  for (int z = -15; z <= 15; ++z) {
    const Side &a = turned.Find(z)->left, &b = back.trace.Find(z)->left;
    EXPECT_EQ(a.known(), b.known());
    if (!a.known()) continue;
    EXPECT_NEAR(a.distance_m.low, b.distance_m.low, 1e-5);
    ++known;
  }
  EXPECT_GT(known, 5);
}

}  // namespace
}  // namespace cairn::local_map
