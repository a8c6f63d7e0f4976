#include "pipelines/local_map/traces/correlation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "pipelines/local_map/testing/drive.h"

namespace cairn::local_map {
namespace {

// In a room all of whose walls are in the grids, both coordinates are found.
TEST(CorrelateGrids, FindsTheRobotInARoomThatItKnows) {
  Drive drive({{{-1.5, -1.2}, {1.5, -1.2}},
               {{1.5, -1.2}, {1.5, 1.2}},
               {{1.5, 1.2}, {-1.5, 1.2}},
               {{-1.5, 1.2}, {-1.5, -1.2}}},
              {-0.5, 0, 0}, 1);
  const TraceFrame frame{0, {0, 0}};
  GridMap map(0.15, -30, 60, 30);
  for (int k = 0; k < 8; ++k) {
    drive.Step();
    map.Add(drive.grids(), frame);
  }
  const CellIndex centre = drive.grids().occupancy().centre();
  const Position robot{drive.grids().pose().x_m - centre.i * 0.15,
                       drive.grids().pose().y_m - centre.j * 0.15};
  const Position truth{drive.pose().x_m, drive.pose().y_m};
  const Position found =
      CorrelateGrids(map, MapOfNow(drive.grids(), 0), robot, {truth.z_m + 0.3, truth.u_m - 0.2}, {0.6, 0.6});
  EXPECT_NEAR(found.z_m, truth.z_m, 0.06);
  EXPECT_NEAR(found.u_m, truth.u_m, 0.06);
}

// What is z in a trace is u in one that lies across it: both have the same to say of the same place, to a
// fraction of a cell.
TEST(CorrelateGrids, ATraceThatLiesAcrossGivesTheSamePlace) {
  constexpr double kCell_m = 0.15;
  Drive drive({{{-1.5, -1.2}, {1.5, -1.2}}, {{1.5, -1.2}, {1.1, 1.2}}, {{-1.5, 0.9}, {-1.2, -1.2}}},
              {-0.5, 0.1, 0.2}, 1);
  const TraceFrame first{0, {0, 0}}, across{1, {0, 0}};
  GridMap map(kCell_m, -30, 61, 30), map_across(kCell_m, -30, 61, 30);
  double between_x = 0, between_y = 0;  // by how much of a cell the place lies between cells, at most
  for (int k = 0; k < 15; ++k) {
    drive.Step(0.03);
    map.Add(drive.grids(), first);
    map_across.Add(drive.grids(), across);
    const CellIndex centre = drive.grids().occupancy().centre();
    const Point pose{drive.grids().pose().x_m, drive.grids().pose().y_m};
    const auto find = [&](const GridMap& in, const TraceFrame& frame) {
      const Position robot = TraceFrame{frame.quarter, centre}.At(pose, kCell_m);
      const Position at = frame.At({pose.x_m + 0.21, pose.y_m - 0.16}, kCell_m);
      const GridMap now = MapOfNow(drive.grids(), frame.quarter);
      return frame.Local(CorrelateGrids(in, now, robot, at, {0.6, 0.6}), kCell_m);
    };
    const Point a = find(map, first), b = find(map_across, across);
    EXPECT_NEAR(a.x_m, b.x_m, 1e-5) << k;
    EXPECT_NEAR(a.y_m, b.y_m, 1e-5) << k;
    const auto between = [](double off_m) { return std::abs(std::remainder(off_m, kCell_m)) / kCell_m; };
    between_x = std::max(between_x, between(a.x_m - pose.x_m));
    between_y = std::max(between_y, between(a.y_m - pose.y_m));
  }
  EXPECT_GT(between_x, 0.02);
  EXPECT_GT(between_y, 0.02);
}

// A robot that went so far away, whichever way, that the place is out of its window.
TEST(GridMap, WhatAScanDoesNotReachItSaysNothingOf) {
  for (int quarter = 0; quarter < 4; ++quarter) {
    Drive drive({{{-0.9, -0.9}, {0.9, -0.9}},
                 {{0.9, -0.9}, {0.9, 0.9}},
                 {{0.9, 0.9}, {-0.9, 0.9}},
                 {{-0.9, 0.9}, {-0.9, -0.9}}},
                {0, 0, quarter * std::numbers::pi / 2}, 1);
    for (int k = 0; k < 5; ++k) drive.Scan();
    GridMap map(0.15, -60, 121, 60);
    map.Add(drive.grids(), {0, {0, 0}});
    std::vector<CellIndex> walls;
    for (int z = -15; z <= 15; ++z)
      for (int u = -15; u <= 15; ++u)
        if (map.At(z, u) == 1) walls.push_back({z, u});
    EXPECT_GT(walls.size(), 12U);
    drive.walls().clear();
    drive.Ahead(6);
    map.Add(drive.grids(), {0, {0, 0}});
    for (const CellIndex& wall : walls) EXPECT_EQ(map.At(wall.i, wall.j), 1) << quarter;
  }
}

TEST(CorrelateGrids, LeavesThePositionWhereNothingIsKnown) {
  const GridMap empty(0.15, -15, 31, 15);
  const Position found = CorrelateGrids(empty, empty, {0, 0}, {0.3, 0.15}, {0.5, 0.5});
  EXPECT_NEAR(found.z_m, 0.3, 1e-9);
  EXPECT_NEAR(found.u_m, 0.15, 1e-9);
}

}  // namespace
}  // namespace cairn::local_map
