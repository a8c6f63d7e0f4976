#include "pipelines/forward_map/tiles.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pipelines/common/beam_cells.h"
#include "pipelines/forward_map/testing.h"

namespace cairn::forward_map {
namespace {

Load UnevenLoad() {
  Load load{100, 70, {}};  // 7 x 5 blocks, the last ones cut short
  for (std::int32_t block = 0; block < 7 * 5; ++block) load.crossings.push_back(1 + block % 4 * 100);
  return load;
}

TEST(CutTiles, CoverEachCellOnce) {
  for (const double share : {0.35, 0.5}) {
    const std::vector<Tile> tiles = CutTiles(UnevenLoad(), 700, share);
    ASSERT_GT(tiles.size(), 5U);
    std::vector<int> covered(100 * 70);
    for (const Tile& tile : tiles) {
      for (std::int32_t row = tile.row; row < tile.row + tile.rows; ++row)
        for (std::int32_t column = tile.column; column < tile.column + tile.columns; ++column)
          ++covered[static_cast<std::size_t>(row * 100 + column)];
    }
    EXPECT_EQ(covered, std::vector<int>(100 * 70, 1));
  }
}

TEST(CutTiles, HaveBordersThatDifferByTheShare) {
  const Load load = UnevenLoad();
  EXPECT_NE(CutTiles(load, 700, 0.35), CutTiles(load, 700, 0.5));
  EXPECT_EQ(CutTiles(load, 1e9, 0.5), (std::vector<Tile>{{0, 0, 100, 70}}));
  EXPECT_EQ(CutTiles(load, 0, 0.5).size(), 35U);  // blocks are never cut
  EXPECT_EQ(RowsIn<Tile>(BlobOf(CutTiles(load, 700, 0.35))), CutTiles(load, 700, 0.35));
}

TEST(EstimateLoad, IsAboutTheNumberOfCellsThatBeamsMeet) {
  for (const double opening_rad : {0.0, 0.4}) {
    const Room room{.opening_rad = opening_rad};
    const MapState map = EmptyMapOf(room, 0.1);
    const std::vector<RangeScans> sensors = SensorsOf(room);
    std::vector<BeamCell> cells;
    double crossings = 0;
    const auto range = sensors[0].range_m.As<double>();
    for (std::size_t i = 0; i < range.size(); ++i) {
      const std::size_t beams = sensors[0].beams.size();
      BeamCells(map.box, sensors[0].BeamPose(i / beams, i % beams), opening_rad,
                std::isnan(range[i]) ? 4 : range[i], &cells);
      crossings += static_cast<double>(cells.size());
    }
    const double estimate = EstimateLoad(sensors, map.box, 0).Sum();
    EXPECT_GT(estimate, 0.7 * crossings) << opening_rad;
    EXPECT_LT(estimate, 1.6 * crossings) << opening_rad;
  }
}

}  // namespace
}  // namespace cairn::forward_map
