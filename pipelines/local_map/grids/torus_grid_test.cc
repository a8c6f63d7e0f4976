#include "pipelines/local_map/grids/torus_grid.h"

#include <gtest/gtest.h>

#include <map>
#include <utility>

#include "schema/rng.h"

namespace cairn::local_map {
namespace {

TEST(TorusGrid, TheRobotIsAlwaysInTheCentralCell) {
  TorusGrid<int> grid(0.15, 7);
  Rng rng(1);
  for (int k = 0; k < 1000; ++k) {
    const double x = rng.Uniform(-50, 50), y = rng.Uniform(-50, 50);
    grid.MoveTo(x, y);
    EXPECT_LE(std::abs(x - grid.centre().i * 0.15), 0.075 + 1e-12);
    EXPECT_LE(std::abs(y - grid.centre().j * 0.15), 0.075 + 1e-12);
    EXPECT_EQ(grid.robot().x_m, x);
  }
}

// The paper's own case, [DM98] section 2.2: one cell up, the row that was the far edge is the new one, and
// empty.
TEST(TorusGrid, WhatScrollsOutIsForgottenAndTheRestStays) {
  TorusGrid<int> grid(1, 7);
  for (int j = -7; j <= 7; ++j)
    for (int i = -7; i <= 7; ++i) *grid.Touch(i, j) = 100 * i + j;
  grid.MoveTo(0, 1);
  for (int j = -6; j <= 7; ++j)
    for (int i = -7; i <= 7; ++i) EXPECT_EQ(*grid.Find(i, j), 100 * i + j);
  for (int i = -7; i <= 7; ++i) {
    EXPECT_EQ(grid.Find(i, 8), nullptr);
    EXPECT_EQ(grid.Find(i, -7), nullptr);
    EXPECT_EQ(grid.Touch(i, -7), nullptr);
  }
  EXPECT_EQ(*grid.Touch(3, 8), 0);
  grid.MoveTo(0, 0);
  EXPECT_EQ(grid.Find(3, -7), nullptr);  // its place in the array was taken
  EXPECT_EQ(*grid.Find(4, -7), 393);     // this one's was not: it comes back
}

// Against a map without end, of which a cell is forgotten once another took its place.
TEST(TorusGrid, HoldsWhatAMapWithoutEndHolds) {
  TorusGrid<int> grid(0.5, 3);
  std::map<std::pair<int, int>, int> all;
  Rng rng(2);
  double x = 0, y = 0;
  int found = 0;
  for (int k = 1; k < 5000; ++k) {
    x += rng.Uniform(-0.6, 0.6);
    y += rng.Uniform(-0.6, 0.6);
    grid.MoveTo(x, y);
    const int i = grid.centre().i + static_cast<int>(rng.Below(7)) - 3;
    const int j = grid.centre().j + static_cast<int>(rng.Below(7)) - 3;
    const auto place = [](int n) { return ((n % 7) + 7) % 7; };
    std::erase_if(all, [&](const auto& entry) {
      return place(entry.first.first) == place(i) && place(entry.first.second) == place(j);
    });
    *grid.Touch(i, j) = k;
    all[{i, j}] = k;
    for (const auto& [at, value] : all) {
      const bool inside =
          std::abs(at.first - grid.centre().i) <= 3 && std::abs(at.second - grid.centre().j) <= 3;
      EXPECT_EQ(grid.Holds(at.first, at.second), inside);
      if (!inside) continue;
      ASSERT_NE(grid.Find(at.first, at.second), nullptr);
      EXPECT_EQ(*grid.Find(at.first, at.second), value);
      ++found;
    }
    int known = 0;
    grid.ForEach([&](int, int, int) { ++known; });
    EXPECT_LE(known, static_cast<int>(all.size()));
  }
  EXPECT_GT(found, 10000);
}

}  // namespace
}  // namespace cairn::local_map
