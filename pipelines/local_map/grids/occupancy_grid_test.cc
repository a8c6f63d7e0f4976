#include "pipelines/local_map/grids/occupancy_grid.h"

#include <gtest/gtest.h>

#include <cmath>

#include "schema/rng.h"

namespace cairn::local_map {
namespace {

TEST(OccupancyGrid, FrequencyConvergesToTheShareOfScansThatHit) {
  OccupancyGrid grid(0.15, 5, 0.99, 0.08);
  double sum = 0;
  int counted = 0;
  for (int scan = 0; scan < 4000; ++scan) {
    grid.NextScan();
    grid.Hit({0.01, 0});                        // each scan
    if (scan % 4 == 0) grid.Hit({0.15, 0.01});  // one in four
    if (scan < 2000) continue;
    sum += grid.Frequency(1, 0);
    ++counted;
  }
  EXPECT_NEAR(grid.Frequency(0, 0), 1, 1e-5);
  EXPECT_NEAR(sum / counted, 0.25, 1e-3);
  EXPECT_EQ(grid.Frequency(2, 0), 0);
}

// The paper's update done as it stands: all cells decay each scan. C is read after the hit.
TEST(OccupancyGrid, LateDecayEqualsThePapersOwn) {
  constexpr double kKept = 0.9;
  OccupancyGrid grid(1, 3, kKept, 0.08);
  double counts[7][7] = {};
  Rng rng(5);
  for (int scan = 0; scan < 300; ++scan) {
    grid.NextScan();
    for (auto& row : counts)
      for (double& count : row) count *= kKept;
    for (int hit = static_cast<int>(rng.Below(4)); hit > 0; --hit) {
      const auto i = static_cast<int>(rng.Below(7)), j = static_cast<int>(rng.Below(7));
      EXPECT_TRUE(grid.Hit({i - 3.0, j - 3.0}));
      ++counts[j][i];
    }
    for (int j = 0; j < 7; ++j)
      for (int i = 0; i < 7; ++i) EXPECT_NEAR(grid.Frequency(i - 3, j - 3), counts[j][i] * (1 - kKept), 1e-6);
  }
}

TEST(OccupancyGrid, KeepsTheLastHitOfACellFinerThanTheCell) {
  OccupancyGrid grid(0.6, 3, 0.95, 0.08);
  grid.MoveTo(31.3, -20.1);
  grid.NextScan();
  EXPECT_TRUE(grid.Hit({31.21, -20.3}));
  EXPECT_TRUE(grid.Hit({31.27, -20.33}));
  EXPECT_FALSE(grid.Hit({35, -20}));
  const std::int32_t i = CellOf(31.27, 0.6), j = CellOf(-20.33, 0.6);
  ASSERT_TRUE(grid.LastHit(i, j));
  EXPECT_NEAR(grid.LastHit(i, j)->x_m, 31.27, 1e-6);
  EXPECT_NEAR(grid.LastHit(i, j)->y_m, -20.33, 1e-6);
  EXPECT_FALSE(grid.LastHit(i + 1, j));
}

// A wall of hits through a grid: turned, it is the same wall, turned about the robot; little is lost.
TEST(OccupancyGrid, TurnsByItsHitsWithLittleLoss) {
  for (const double degrees : {3.0, 8.0, 45.0, -90.0}) {
    OccupancyGrid grid(0.15, 15, 0.95, 0.04);
    grid.MoveTo(10.04, 5.03);
    grid.NextScan();
    Rng rng(3);
    int before = 0;
    for (int k = -12; k <= 12; ++k)
      grid.Hit({10 + 0.15 * k + 0.02 * rng.Normal(), 6.2 + 0.02 * rng.Normal()});
    grid.ForOccupied({50, 25}, {85, 50}, [&](Point) { ++before; });
    grid.Turn(RadOf(degrees));
    int after = 0;
    const double c = std::cos(-RadOf(degrees)), s = std::sin(-RadOf(degrees));
    const CellIndex at = grid.centre();
    grid.ForOccupied({at.i - 15, at.j - 15}, {at.i + 15, at.j + 15}, [&](Point p) {
      ++after;
      const double x = p.x_m - 10.04, y = p.y_m - 5.03;
      EXPECT_NEAR(s * x + c * y, 6.2 - 5.03, 0.07);  // turned back it lies on the wall
    });
    EXPECT_GE(before, 20);
    EXPECT_GE(after, before * 3 / 4) << degrees;
    EXPECT_LE(after, before);
  }
}

// (1.6, 0.4) and (1.4, 0.4) turn into the cell (1, 1), whichever was hit first.
TEST(OccupancyGrid, CountsThatMeetInACellAddUpAndTheLaterHitStays) {
  for (const double later_m : {1.4, 1.6}) {
    OccupancyGrid grid(1, 3, 0.5, 0.08);
    grid.NextScan();
    grid.Hit({3.0 - later_m, 0.4});
    grid.NextScan();
    grid.Hit({later_m, 0.4});
    grid.NextScan();
    const double c = std::cos(0.5), s = std::sin(0.5);
    grid.Turn(0.5);
    EXPECT_NEAR(grid.Frequency(1, 1), 0.5 * (0.25 + 0.5), 1e-6) << later_m;
    EXPECT_EQ(grid.Frequency(1, 0) + grid.Frequency(2, 0) + grid.Frequency(2, 1), 0) << later_m;
    ASSERT_TRUE(grid.LastHit(1, 1));
    EXPECT_NEAR(grid.LastHit(1, 1)->x_m, c * later_m - s * 0.4, 1e-6);
    EXPECT_NEAR(grid.LastHit(1, 1)->y_m, s * later_m + c * 0.4, 1e-6);
  }
}

}  // namespace
}  // namespace cairn::local_map
