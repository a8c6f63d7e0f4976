#include "pipelines/evidence_map/ray_counts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "pipelines/evidence_map/testing.h"
#include "schema/rng.h"

namespace cairn::evidence_map {
namespace {

const double kNone = std::nan("");
constexpr double kPi = std::numbers::pi;

Totals Whole(const RangeScans& scans, const GridBox& grid, bool use_no_return = true) {
  Untroubled progress;
  Totals totals{std::vector<std::int64_t>(static_cast<std::size_t>(grid.cells())),
                std::vector<std::int64_t>(static_cast<std::size_t>(grid.cells()))};
  AddTo(grid, ToBlob(CountRays(scans, grid, use_no_return, progress)), &totals);
  return totals;
}

using Column = std::vector<std::int64_t>;

TEST(CountRays, ByHandAlongARow) {
  const GridBox grid{0, 0, 1, 6, 1};
  const Totals totals = Whole(OneBeam({{0.5, 0.5, 0}}, {3.2}, 0, 10), grid);
  EXPECT_EQ(totals.free, (Column{1, 1, 1, 0, 0, 0}));
  EXPECT_EQ(totals.occupied, (Column{0, 0, 0, 1, 0, 0}));
}

TEST(CountRays, ByHandUpASteepSlopeAndBack) {
  const GridBox grid{0, 0, 1, 3, 4};
  const double up = std::atan2(3, 1);  // from (0.5, 0.5) by (1, 3): at rows' middles x = 0.5, 0.83, 1.17, 1.5
  const Column free{1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0}, occupied{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0};
  EXPECT_EQ(Whole(OneBeam({{0.5, 0.5, up}}, {std::sqrt(10)}, 0, 10), grid).free, free);
  EXPECT_EQ(Whole(OneBeam({{0.5, 0.5, up}}, {std::sqrt(10)}, 0, 10), grid).occupied, occupied);
  const Totals back = Whole(OneBeam({{1.5, 3.5, up - kPi}}, {std::sqrt(10)}, 0, 10), grid);
  EXPECT_EQ(back.free, (Column{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0}));
  EXPECT_EQ(back.occupied[0], 1);
}

// The robot at (2.5, 1.5) looks up, its sensor sits 1 m ahead and 2 m to the left; or it looks to the right,
// the sensor 2 m behind and 1 m to the left: both times at (0.5, 2.5), and looks to the right.
TEST(CountRays, ABeamBeginsWhereItsSensorSits) {
  const GridBox grid{0, 0, 1, 6, 5};
  Column free(30, 0), occupied(30, 0);
  free[12] = free[13] = free[14] = occupied[15] = 1;
  for (const auto& [heading_rad, beam] : {std::pair{kPi / 2, Pose{1, 2, -kPi / 2}}, {0.0, Pose{-2, 1, 0}}}) {
    RangeScans scans = OneBeam({{2.5, 1.5, heading_rad}}, {3}, 0, 10);
    scans.beams[0] = beam;
    EXPECT_EQ(Whole(scans, grid).free, free) << heading_rad;
    EXPECT_EQ(Whole(scans, grid).occupied, occupied) << heading_rad;
  }
}

TEST(CountRays, NoAnswerIsFreeAsFarAsTheSensorReachesOrSaysNothing) {
  const GridBox grid{0, 0, 1, 6, 1};
  const RangeScans scans = OneBeam({{0.5, 0.5, 0}}, {kNone}, 0, 2.2);
  EXPECT_EQ(Whole(scans, grid).free, (Column{1, 1, 1, 0, 0, 0}));
  EXPECT_EQ(Whole(scans, grid).occupied, Column(6, 0));
  EXPECT_EQ(Whole(scans, grid, false).free, Column(6, 0));
}

TEST(CountRays, WhatLeavesTheGridIsFreeUpToItsBorder) {
  const GridBox grid{0, 0, 1, 3, 2};
  const Totals out = Whole(OneBeam({{0.5, 0.5, 0}}, {9}, 0, 10), grid);
  EXPECT_EQ(out.free, (Column{1, 1, 1, 0, 0, 0}));
  EXPECT_EQ(out.occupied, Column(6, 0));
  const Totals through = Whole(OneBeam({{-5, 1.5, 0}}, {7.5}, 0, 10), grid);
  EXPECT_EQ(through.free, (Column{0, 0, 0, 1, 1, 0}));
  EXPECT_EQ(through.occupied, (Column{0, 0, 0, 0, 0, 1}));
  EXPECT_EQ(Whole(OneBeam({{-5, 7, 0}}, {9}, 0, 10), grid).free, Column(6, 0));
}

TEST(CountRays, HeldOutScansSayNothing) {
  const GridBox grid{0, 0, 1, 6, 1};
  RangeScans scans = OneBeam({{0.5, 0.5, 0}, {0.5, 0.5, 0}}, {3.2, 3.2}, 0, 10);
  scans.held_out[1] = 1;
  EXPECT_EQ(Whole(scans, grid).occupied[3], 1);
}

TEST(CountRays, MoreRaysThanAHalfWordCountsAreCounted) {
  const GridBox grid{0, 0, 1, 3, 1};
  constexpr std::size_t kRays = 70000;
  const Totals totals =
      Whole(OneBeam(std::vector<Pose>(kRays, {0.5, 0.5, 0}), std::vector<double>(kRays, 2), 0, 10), grid);
  EXPECT_EQ(totals.free, (Column{kRays, kRays, 0}));
  EXPECT_EQ(totals.occupied, (Column{0, 0, kRays}));
}

RangeScans ManyRays(std::size_t count) {
  Rng rng(11);
  std::vector<Pose> poses;
  std::vector<double> range;
  for (std::size_t s = 0; s < count; ++s) {
    poses.push_back({-1 + 12 * rng.Uniform(), -1 + 9 * rng.Uniform(), kPi * (2 * rng.Uniform() - 1)});
    range.push_back(rng.Uniform() < 0.1 ? kNone : 6 * rng.Uniform());
  }
  return OneBeam(poses, range, 0, 6);
}

// The definition, in a plain way: for each column (row) that the ray passes, the cell at its middle.
TEST(CountRays, OfRaysWithinTheGridAreThoseOfTheDefinition) {
  const GridBox grid{-0.3, 0.2, 0.1, 100, 70};
  RangeScans scans = ManyRays(800);
  std::map<std::int64_t, std::int64_t> free, occupied;
  const auto add = [&](double x, double y, auto* to) {
    const auto i = static_cast<std::int64_t>(std::floor(x)), j = static_cast<std::int64_t>(std::floor(y));
    if (grid.Holds(i, j)) ++(*to)[j * grid.columns + i];
  };
  const auto inside = [&](const Pose& p) { return grid.Holds(grid.ColumnOf(p.x_m), grid.RowOf(p.y_m)); };
  for (std::size_t s = 0; s < scans.scans(); ++s) {
    const double range_m = scans.range_m.As<double>()[s];
    const Pose& from = scans.pose[s];
    const Pose to = Compose(from, {std::isnan(range_m) ? 6 : range_m, 0, 0});
    if (!inside(from) || !inside(to)) {
      scans.held_out[s] = 1;
      continue;
    }
    double u0 = (from.x_m + 0.3) * 10, u1 = (to.x_m + 0.3) * 10, w0 = (from.y_m - 0.2) * 10,
           w1 = (to.y_m - 0.2) * 10;
    const bool steep = std::abs(w1 - w0) > std::abs(u1 - u0);
    if (steep) std::swap(u0, w0), std::swap(u1, w1);
    const double way = u1 >= u0 ? 1 : -1, slope = (w1 - w0) / (u1 - u0);
    for (double u = std::floor(u0); u != std::floor(u1); u += way) {
      const double w = w0 + (u + 0.5 - u0) * slope;
      steep ? add(w, u, &free) : add(u, w, &free);
    }
    steep ? add(w1, u1, std::isnan(range_m) ? &free : &occupied)
          : add(u1, w1, std::isnan(range_m) ? &free : &occupied);
  }
  const Totals totals = Whole(scans, grid);
  std::int64_t all = 0;
  for (std::int64_t k = 0; k < grid.cells(); ++k) {
    all += free[k] + occupied[k];
    ASSERT_EQ(totals.free[static_cast<std::size_t>(k)], free[k]) << k;
    ASSERT_EQ(totals.occupied[static_cast<std::size_t>(k)], occupied[k]) << k;
  }
  EXPECT_GT(all, 5000);
}

TEST(CountRays, PartsAddUpToTheWhole) {
  const GridBox grid{-0.3, 0.2, 0.1, 100, 70};
  const RangeScans scans = ManyRays(400);
  Untroubled progress;
  Totals sum{std::vector<std::int64_t>(7000), std::vector<std::int64_t>(7000)};
  for (std::size_t first = 0; first < 400; first += 50) {
    const Counts counts = CountRays(ScansFrom(scans, first, 50), grid, true, progress);
    AddTo(grid, ToBlob(counts), &sum);
  }
  const Totals whole = Whole(scans, grid);
  EXPECT_EQ(sum.occupied, whole.occupied);
  EXPECT_EQ(sum.free, whole.free);
}

// What is kept in bytes, and what is beyond; the window lies partly outside of the grid.
TEST(Counts, OfAPartialAddUpAsTheyWere) {
  const GridBox grid{0, 0, 1, 3, 3};
  Counts counts{.box = {-1, -1, 1, 3, 2}, .first_column = -1, .first_row = -1, .free = {}, .occupied = {}};
  counts.free = {1, 2, 3, 4, 0x12345678, 65'535};
  counts.occupied = {7, 0, 0, 0, 0, 1'000'000};
  Totals totals{std::vector<std::int64_t>(9), std::vector<std::int64_t>(9)};
  for (int times = 0; times < 3; ++times) AddTo(grid, ToBlob(counts), &totals);
  EXPECT_EQ(totals.free, (std::vector<std::int64_t>{3 * 0x12345678LL, 3 * 65'535, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(totals.occupied, (std::vector<std::int64_t>{0, 3'000'000, 0, 0, 0, 0, 0, 0, 0}));
}

TEST(Counts, OfWhichFewAreLargeTakeAByteACell) {
  const GridBox grid{0, 0, 1, 100, 1};
  Counts counts{.box = grid, .first_column = 0, .first_row = 0, .free = {}, .occupied = {}};
  counts.free.resize(100, 255);
  counts.occupied.resize(100);
  counts.free[7] = 0x12345678;
  const Blob partial = ToBlob(counts);
  EXPECT_EQ(partial.Get<std::uint8_t>("free_high").size(), 0U);
  Totals totals{std::vector<std::int64_t>(100), std::vector<std::int64_t>(100)};
  AddTo(grid, partial, &totals);
  EXPECT_TRUE(std::ranges::equal(totals.free, counts.free));
}

}  // namespace
}  // namespace cairn::evidence_map
