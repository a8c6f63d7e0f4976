#include "datasets/reproduce/local/study.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "datasets/reproduce/local/figures.h"
#include "datasets/reproduce/local/wall_coverage.h"
#include "datasets/testing.h"

namespace cairn::datasets {
namespace {

TEST(LocalStudy, EachOfficeIsMappedAsItStandsWithFurnitureThatMovesAndWithATurnedRoom) {
  const LocalStudy study = MakeLocalStudy(7, 2);
  ASSERT_EQ(study.kinds.size(), 3U);
  EXPECT_EQ(study.inputs.size(), 6U);
  EXPECT_EQ(study.job.stages_size(), 6);
  for (const proto::Stage& stage : study.job.stages())
    EXPECT_TRUE(study.inputs.contains(stage.inputs().at("log"))) << stage.name();
  for (const std::string& name : study.kinds[1].logs) {
    double latest_s = 0;
    for (const double from_s : study.inputs.at(name).Get<double>("truth/walls/from_s"))
      latest_s = std::max(latest_s, from_s);
    EXPECT_GT(latest_s, 60) << name;
  }
  for (const std::string& name : study.kinds[2].logs) {
    const auto angle = study.inputs.at(name).Get<double>("truth/robot/0/walls/angle_rad");
    EXPECT_GT(*std::ranges::max_element(angle), 0.5) << name;
  }
}

TEST(LocalStudy, AMissingResultIsNamed) {
  ExpectContains(InputErrorOf([] { LocalFigures(MakeLocalStudy(7, 1), {}); }), "office_7_map");
}

// By hand: a robot at the origin between smooth walls at y = 1 and y = -1; odometry is turned by a quarter,
// so that in the grids the walls are at x = -1 and x = 1. Of the upper one all is hit, of the lower one
// nothing.
TEST(WallCoverage, LooksWhereTheGridsHaveTheWalls) {
  constexpr std::int64_t kCells = 21;
  constexpr float kNo = std::numeric_limits<float>::quiet_NaN();
  Blob log;
  log.Put("robots", Array::Texts({"ann"}));
  log.Put("truth/walls/x_m", Array::Of<double>({3, 2}, std::vector<double>{-1, 1, -1, 1, -1, 1}));
  log.Put("truth/walls/y_m", Array::Of<double>({3, 2}, std::vector<double>{1, 1, -1, -1, 0.5, 0.5}));
  log.PutVector<std::uint8_t>("truth/walls/smooth", {1, 1, 0});
  log.PutVector<double>("truth/robot/0/poses/time_s", {0, 1});
  for (const char* column : {"x_m", "y_m", "heading_rad"})
    log.PutVector<double>(std::string("truth/robot/0/poses/") + column, {0, 0});
  log.PutVector<double>("robot/0/odometry/time_s", {0, 1});
  log.PutVector<double>("robot/0/odometry/turn_rad", {M_PI / 2, 0});
  log.PutVector<double>("robot/0/odometry/forward_m", {0, 0});
  Blob result;
  result.Put("robots", log.at("robots"));
  result.PutScalar("cell_m", 0.2);
  for (const char* name :
       {"robot/0/poses/time_s", "robot/0/poses/x_m", "robot/0/poses/y_m", "robot/0/poses/heading_rad",
        "traces/first_s", "traces/last_s", "traces/x_m", "traces/y_m", "traces/direction_rad",
        "connections/from_z_m", "connections/from_u_m", "connections/to_z_m", "connections/to_u_m",
        "snapshots/edge/x0_m", "snapshots/edge/y0_m", "snapshots/edge/x1_m", "snapshots/edge/y1_m"})
    result.PutVector<double>(name, {});
  for (const char* name :
       {"traces/robot", "traces/first_z", "connections/from", "connections/to", "connections/kind"})
    result.PutVector<std::int32_t>(name, {});
  result.PutVector<std::int64_t>("traces/features", {});
  result.PutVector<std::uint8_t>("connections/used", {});
  for (const char* side : {"left/", "right/"}) {
    for (const char* name : {"angle_low_rad", "angle_high_rad", "distance_low_m", "distance_high_m"})
      result.PutVector<float>(std::string("features/") + side + name, {});
    result.PutVector<std::uint8_t>(std::string("features/") + side + "occupied", {});
  }
  result.PutVector<double>("snapshots/time_s", {0.5});
  result.PutVector<std::int32_t>("snapshots/robot", {0});
  result.PutVector<double>("snapshots/frame_rad", {0});
  result.Put("snapshots/histogram", Array::Of<double>({1, 8}, std::vector<double>(8, 0)));
  result.PutVector<std::int64_t>("snapshots/edges", {0});
  std::vector<float> hits(kCells * kCells, 0), edges(kCells * kCells, kNo);
  for (std::int64_t row = 0; row < kCells; ++row) {
    hits[static_cast<std::size_t>(row * kCells + 5)] = 0.5F;                   // x = -1 m
    if (row < 10) edges[static_cast<std::size_t>(row * kCells + 15)] = 1.57F;  // x = 1 m, y below 0
  }
  result.Put("snapshots/occupancy", Array::Of<float>({1, kCells, kCells}, hits));
  result.Put("snapshots/edge_rad", Array::Of<float>({1, kCells, kCells}, edges));
  const WallCoverage coverage = MetallicCoverage(result, log);
  EXPECT_NEAR(coverage.wall_m, 4, 1e-9);
  EXPECT_NEAR(coverage.by_hits_m, 2, 1e-9);
  EXPECT_NEAR(coverage.by_edges_m, 1, 0.21);
}

}  // namespace
}  // namespace cairn::datasets
