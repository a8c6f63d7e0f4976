#include "pipelines/local_map/correlation.h"

#include <gtest/gtest.h>

#include "pipelines/local_map/testing_drive.h"

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

TEST(CorrelateGrids, LeavesThePositionWhereNothingIsKnown) {
  const GridMap empty(0.15, -15, 31, 15);
  const Position found = CorrelateGrids(empty, empty, {0, 0}, {0.3, 0.15}, {0.5, 0.5});
  EXPECT_NEAR(found.z_m, 0.3, 1e-9);
  EXPECT_NEAR(found.u_m, 0.15, 1e-9);
}

}  // namespace
}  // namespace cairn::local_map
