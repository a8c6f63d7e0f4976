#include "pipelines/local_map/grids/edge_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace cairn::local_map {
namespace {

Edge Line(Point a, Point b) { return {a, b, std::atan2(b.y_m - a.y_m, b.x_m - a.x_m), 0.02, 10}; }

TEST(EdgeGrid, CellsThatAnEdgeGoesThroughCarryItsDirection) {
  EdgeGrid grid(0.15, 15, 0.99, {0.6, 1.5});
  const Edge edge = Line({-1, 0.7}, {1.2, 1.1});
  for (int k = 0; k < 3; ++k) grid.Add(std::vector{edge});
  int cells = 0;
  for (int j = -15; j <= 15; ++j) {
    for (int i = -15; i <= 15; ++i) {
      const auto found = grid.Dominant(i, j);
      if (!found) continue;
      ++cells;
      EXPECT_NEAR(found->angle_rad, edge.angle_rad, 1e-5);
      EXPECT_EQ(CellOf(found->at.x_m, 0.15), i);
      EXPECT_EQ(CellOf(found->at.y_m, 0.15), j);
      const double along = (found->at.x_m + 1) / 2.2;
      EXPECT_NEAR(found->at.y_m, 0.7 + 0.4 * along, 1e-5);  // on the edge
      EXPECT_NEAR(found->weight, 1 + 0.99 + 0.99 * 0.99, 1e-5);
    }
  }
  EXPECT_EQ(cells, 16);  // columns -7 to 8
}

TEST(EdgeGrid, OneEdgeIsNoDominantDirectionNorAreTwoThatCross) {
  EdgeGrid grid(0.15, 15, 0.99, {0.6, 1.5});
  const Edge flat = Line({-1, 0}, {1, 0}), steep = Line({0, -1}, {0, 1});
  grid.Add(std::vector{flat});
  EXPECT_FALSE(grid.Dominant(0, 0));
  for (int k = 0; k < 20; ++k) grid.Add(std::vector{flat, steep});
  EXPECT_TRUE(grid.Dominant(3, 0));
  EXPECT_TRUE(grid.Dominant(0, 3));
  EXPECT_FALSE(grid.Dominant(0, 0));
}

TEST(EdgeGrid, ForgetsSlowlyAndWhatScrolledOut) {
  EdgeGrid grid(0.15, 15, 0.99, {0.6, 1.5});
  const Edge edge = Line({-1, 0.7}, {1, 0.7});
  for (int k = 0; k < 30; ++k) grid.Add(std::vector{edge});
  for (int k = 0; k < 100; ++k) grid.Add({});  // 0.95^100 would leave nothing
  EXPECT_TRUE(grid.Dominant(0, 5));
  grid.MoveTo(5, 0);
  EXPECT_FALSE(grid.Dominant(0, 5));
}

TEST(EdgeGrid, TurnsWithItsDirections) {
  EdgeGrid grid(0.15, 15, 0.99, {0.6, 1.5});
  grid.MoveTo(4.03, 1.02);
  const double angle = RadOf(8);
  const Edge edge = Line({3, 2}, {3 + 2 * std::cos(angle), 2 + 2 * std::sin(angle)});
  for (int k = 0; k < 5; ++k) grid.Add(std::vector{edge});
  grid.Turn(-angle);
  int cells = 0;
  for (int j = -15; j <= 15; ++j) {
    for (int i = -15; i <= 15; ++i) {
      const auto found = grid.Dominant(grid.centre().i + i, grid.centre().j + j);
      if (!found) continue;
      ++cells;
      EXPECT_NEAR(found->angle_rad, 0, 1e-5);
      const double x = 3 - 4.03, y = 2 - 1.02;  // where the edge's line lies now
      EXPECT_NEAR(found->at.y_m, 1.02 - std::sin(angle) * x + std::cos(angle) * y, 1e-5);
    }
  }
  EXPECT_GE(cells, 11);  // of 14
}

TEST(EdgeGrid, EdgesBeyondTheWindowAreCut) {
  EdgeGrid grid(0.15, 15, 0.99, {0.6, 1});
  for (int k = 0; k < 5; ++k) grid.Add(std::vector{Line({-50, 0.5}, {50, 0.5}), Line({1, -9}, {1, 9})});
  for (int k = -15; k <= 15; ++k) EXPECT_TRUE(k == 7 || grid.Dominant(k, 3)) << k;
  for (int k = -15; k <= 15; ++k) EXPECT_TRUE(k == 3 || grid.Dominant(7, k)) << k;
}

}  // namespace
}  // namespace cairn::local_map
