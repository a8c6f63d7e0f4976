#include "pipelines/landmark_learning/data/free_cells.h"

#include <gtest/gtest.h>

#include <cmath>

#include "schema/kinds/kind.h"

namespace cairn::landmark_learning {
namespace {

// Rows from the top, as one sees them; '#': occupied, '?': never looked at. Cells of 0.5 m, the lower left
// corner at (-1, 2).
Blob Map(const std::vector<std::string>& picture) {
  std::vector<double> p;
  for (auto row = picture.rbegin(); row != picture.rend(); ++row) {
    for (const char c : *row) p.push_back(c == '#' ? 0.9 : c == '?' ? NAN : 0.1);
  }
  Blob map;
  map.Put("map/grid/probability",
          Array::Of<double>(
              {static_cast<std::int64_t>(picture.size()), static_cast<std::int64_t>(picture[0].size())}, p));
  map.PutScalar("map/grid/origin_x_m", -1.0);
  map.PutScalar("map/grid/origin_y_m", 2.0);
  map.PutScalar("map/grid/cell_m", 0.5);
  return map;
}

TEST(FreeCells, KnowWhichCellHoldsAPlace) {
  const FreeCells cells = FreeCells::Of(Map({"...", ".#?"}));
  EXPECT_EQ(cells.At(-0.9, 2.1), 0U);
  EXPECT_EQ(cells.At(-0.4, 2.1), std::nullopt);  // occupied
  EXPECT_EQ(cells.At(0.1, 2.1), 2U);             // never looked at
  EXPECT_EQ(cells.At(-0.4, 2.6), 4U);
  EXPECT_EQ(cells.At(-1.1, 2.1), std::nullopt);
  EXPECT_EQ(cells.At(0.0, 3.1), std::nullopt);
}

TEST(FreeCells, APathGoesRoundAWall) {
  const FreeCells cells = FreeCells::Of(Map({".....", ".###.", ".###.", "....."}));
  const auto paths_m = cells.PathLengthsFrom(5);  // the second row from below, first column
  EXPECT_DOUBLE_EQ(paths_m[5], 0.0);
  EXPECT_DOUBLE_EQ(paths_m[9], 0.5 * 6);  // down, four to the right, up: no corner is cut
  EXPECT_TRUE(std::isinf(paths_m[6]));
}

TEST(FreeCells, InTheOpenAPathIsTheStraightLineUpToThreePerCent) {
  const FreeCells cells = FreeCells::Of(Map(std::vector<std::string>(41, std::string(41, '.'))));
  const auto paths_m = cells.PathLengthsFrom(20 * 41 + 20);
  for (int y = 0; y < 41; ++y) {
    for (int x = 0; x < 41; ++x) {
      const double straight = 0.5 * std::hypot(x - 20, y - 20),
                   path_m = paths_m[static_cast<std::size_t>(y * 41 + x)];
      EXPECT_GE(path_m, straight - 1e-9);
      EXPECT_LE(path_m, 1.028 * straight + 1e-9);
    }
  }
}

TEST(FreeCells, WhatIsNoMapIsRefused) {
  EXPECT_THROW(FreeCells::Of(Blob()), InputError);
  Blob map = Map({".."});
  map.PutScalar("map/grid/cell_m", 0.0);
  EXPECT_THROW(CheckInput(map, "map"), InputError);
  map.Put("map/grid/probability", Array::Of<double>({1, 1, 2}, std::vector<double>{0, 0}));
  EXPECT_THROW(FreeCells::Of(map), InputError);
}

}  // namespace
}  // namespace cairn::landmark_learning
