#include "pipelines/local_map/grids/line_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "schema/rng.h"

namespace cairn::local_map {
namespace {

OccupancyGrid Grid() { return {0.15, 15, 0.95, 0.04}; }

// Hits along a line, `apart_m` apart; into the grid too.
std::vector<Point> Row(OccupancyGrid* grid, Point a, double angle_rad, double length_m, double apart_m,
                       double noise_m = 0) {
  Rng rng(11);
  std::vector<Point> hits;
  for (double at = 0; at <= length_m; at += apart_m) {
    const double off = noise_m * rng.Normal();
    hits.push_back({a.x_m + at * std::cos(angle_rad) - off * std::sin(angle_rad),
                    a.y_m + at * std::sin(angle_rad) + off * std::cos(angle_rad)});
    if (grid) grid->Hit(hits.back());
  }
  return hits;
}

std::vector<Edge> Find(const std::vector<Point>& hits, const OccupancyGrid& grid, bool closed = false,
                       const LineFitRule& rule = {}) {
  std::vector<Edge> edges;
  edges.reserve(16);
  LineFit(rule, grid.cell_m()).Find(hits, closed, grid, &edges);
  return edges;
}

// Total least squares by search: the angle of the line through the barycentre with the least sum of squares.
double AngleBySearch(const std::vector<Point>& points) {
  double x0 = 0, y0 = 0, best = 1e300, found = 0;
  for (const Point& p : points) {
    x0 += p.x_m / static_cast<double>(points.size());
    y0 += p.y_m / static_cast<double>(points.size());
  }
  for (double angle = -std::numbers::pi / 2; angle < std::numbers::pi / 2; angle += 1e-4) {
    double sum = 0;
    for (const Point& p : points) {
      const double off = (p.y_m - y0) * std::cos(angle) - (p.x_m - x0) * std::sin(angle);
      sum += off * off;
    }
    if (sum < best) {
      best = sum;
      found = angle;
    }
  }
  return found;
}

TEST(CorrectedAngle, IsThatOfTheLineOfLeastSquares) {
  Rng rng(4);
  for (int trial = 0; trial < 20; ++trial) {
    const double angle = rng.Uniform(-1.5, 1.5);
    const auto points = Row(nullptr, {rng.Uniform(-3, 3), rng.Uniform(-3, 3)}, angle, 2, 0.13, 0.05);
    LineSums sums;
    for (const Point& p : points) sums.Add(p.x_m, p.y_m);
    const double off = ModuloAngle(CorrectedAngle(sums) - AngleBySearch(points), std::numbers::pi);
    EXPECT_NEAR(off, 0, 2e-4);
  }
}

// By hand: (-1, -1), (1, 1) lie on 45 degrees, where sum (x^2 - y^2) is 0; steeper, it is negative.
TEST(CorrectedAngle, KnowsTheQuadrant) {
  LineSums diagonal;
  diagonal.Add(-1, -1);
  diagonal.Add(1, 1);
  EXPECT_NEAR(CorrectedAngle(diagonal), std::numbers::pi / 4, 1e-12);
  LineSums steep;
  steep.Add(4, 0);
  steep.Add(5, 2);
  EXPECT_NEAR(CorrectedAngle(steep), std::atan2(2, 1), 1e-12);
}

// Steps 1, 2, 5.
TEST(LineFit, FindsAWallAtAnyAngle) {
  for (int degrees = -85; degrees <= 85; degrees += 10) {
    OccupancyGrid grid = Grid();
    grid.NextScan();
    const double angle = RadOf(degrees);
    const Point a{0.8 * std::sin(angle) - std::cos(angle), -0.8 * std::cos(angle) - std::sin(angle)};
    const auto edges = Find(Row(&grid, a, angle, 2.05, 0.2, 0.005), grid);
    ASSERT_EQ(edges.size(), 1U) << degrees;
    EXPECT_NEAR(DegOf(ModuloAngle(edges[0].angle_rad - angle, std::numbers::pi)), 0, 1);
    EXPECT_NEAR(edges[0].LengthM(), 2, 0.05);
    EXPECT_GE(edges[0].hits, 9);
  }
}

TEST(LineFit, TwoHitsOrACurveAreNoCandidate) {
  OccupancyGrid grid = Grid();
  grid.NextScan();
  Row(&grid, {-1, 1}, 0, 2, 0.1);
  EXPECT_TRUE(Find({{-0.5, 1}, {0.1, 1}}, grid).empty());
  EXPECT_TRUE(Find({{-0.5, 1}, {0, 1.3}, {0.5, 1}}, grid).empty());
  EXPECT_EQ(Find({{-0.5, 1}, {0, 1.01}, {0.5, 1}}, grid).size(), 1U);
}

// The sd that an edge states is that of its angle: over many walls of about fourteen noisy hits, the errors'
// squares are on average n / (n - 2) of the stated variance, for the spread is taken about a line that was
// fitted to the hits.
TEST(LineFit, AnEdgesSdIsThatOfItsAngle) {
  Rng rng(7);
  double squares = 0;
  int walls = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    OccupancyGrid grid = Grid();
    grid.NextScan();
    const double angle = rng.Uniform(-1.5, 1.5);
    const Point a{0.8 * std::sin(angle) - std::cos(angle), -0.8 * std::cos(angle) - std::sin(angle)};
    std::vector<Point> hits;
    for (double at = 0; at < 2.1; at += 0.15) {
      const double off = 0.02 * rng.Normal();
      hits.push_back({a.x_m + at * std::cos(angle) - off * std::sin(angle),
                      a.y_m + at * std::sin(angle) + off * std::cos(angle)});
      grid.Hit(hits.back());
    }
    for (const Edge& edge : Find(hits, grid)) {
      if (edge.LengthM() < 1.8) continue;  // a piece of the wall
      const double error = ModuloAngle(edge.angle_rad - angle, std::numbers::pi) / edge.sd_rad;
      squares += error * error;
      ++walls;
    }
  }
  ASSERT_GT(walls, 900);
  // n = 14; a centimetre is taken for the least spread, beside which the hits have 2 cm.
  EXPECT_NEAR(squares / walls, 14.0 / 12 * 4 / (4 + 1), 0.15);
}

// Step 3: the candidate grows over occupied cells, and gives up what lies behind a hole.
TEST(LineFit, AnEdgeGrowsAndShrinksByTheGrid) {
  OccupancyGrid grid = Grid();
  grid.NextScan();
  Row(&grid, {-1.8, 1}, 0, 3.01, 0.1);  // from -1.8 to 1.2
  const auto grown = Find({{-0.2, 1}, {0.1, 1}, {0.4, 1}}, grid);
  ASSERT_EQ(grown.size(), 1U);
  EXPECT_NEAR(std::min(grown[0].a.x_m, grown[0].b.x_m), -1.8, 0.16);
  EXPECT_NEAR(std::max(grown[0].a.x_m, grown[0].b.x_m), 1.2, 0.16);

  OccupancyGrid holed = Grid();
  holed.NextScan();
  Row(&holed, {-1.8, 1}, 0, 2.41, 0.1);  // to 0.6, and the last hit alone at 1.2
  holed.Hit({1.2, 1});
  LineFitRule rule;
  rule.hole_m = 0.45;
  const auto shrunk = Find({{-0.1, 1}, {0.55, 1}, {1.2, 1}}, holed, false, rule);
  ASSERT_EQ(shrunk.size(), 1U);
  EXPECT_NEAR(std::max(shrunk[0].a.x_m, shrunk[0].b.x_m), 0.6, 0.1);
}

// Step 4: recorded hits decide, beyond those of the scan.
TEST(LineFit, RecordedHitsCorrectTheCandidate) {
  OccupancyGrid grid = Grid();
  grid.NextScan();
  Row(&grid, {-1, 1}, 0, 2.01, 0.1);
  const auto edges = Find({{-0.6, 0.95}, {0, 1}, {0.6, 1.05}}, grid);
  ASSERT_EQ(edges.size(), 1U);
  EXPECT_LT(std::abs(DegOf(edges[0].angle_rad)), 0.5);  // the candidate's is 4.8 degrees
}

TEST(LineFit, WhatIsShortThinOrFullOfHolesIsDiscarded) {
  OccupancyGrid few = Grid();
  few.NextScan();
  EXPECT_TRUE(Find(Row(&few, {-0.5, 1}, 0, 1.01, 0.5), few).empty());  // three hits
  OccupancyGrid small = Grid();
  small.NextScan();
  EXPECT_TRUE(Find(Row(&small, {0, 1}, 0, 0.41, 0.08), small).empty());  // 0.4 m
  OccupancyGrid holed = Grid();
  holed.NextScan();
  EXPECT_TRUE(Find(Row(&holed, {-1, 1}, 0, 2.1, 0.65), holed).empty());  // holes of 0.65 m
  OccupancyGrid thick = Grid();
  thick.NextScan();
  auto hits = Row(&thick, {-1, 1}, 0, 2.01, 0.15);
  Row(&thick, {-0.92, 0.9}, 0, 1.8, 0.15);
  EXPECT_TRUE(Find(hits, thick).empty());  // two rows, 10 cm apart
}

TEST(LineFit, AClosedRingGoesOnAtItsBeginning) {
  OccupancyGrid grid = Grid();
  grid.NextScan();
  Row(&grid, {-1, 1}, 0, 2.01, 0.1);
  const std::vector<Point> hits{{0.3, 1}, {0.7, 1}, {1, 0.2}, {0.2, 0}, {-0.1, 1}};
  EXPECT_TRUE(Find(hits, grid, false).empty());
  EXPECT_EQ(Find(hits, grid, true).size(), 1U);
}

TEST(LineFit, ACornerBelongsToBothWalls) {
  OccupancyGrid grid = Grid();
  grid.NextScan();
  auto hits = Row(&grid, {-1, 1}, 0, 2.01, 0.4);
  const auto down = Row(&grid, {1, 1}, -std::numbers::pi / 2, 2.01, 0.4);
  hits.insert(hits.end(), down.begin() + 1, down.end());
  const auto edges = Find(hits, grid);
  ASSERT_EQ(edges.size(), 2U);
  EXPECT_NEAR(std::abs(DegOf(ModuloAngle(edges[0].angle_rad - edges[1].angle_rad, std::numbers::pi))), 90, 1);
}

// A post stands before it: what is seen to its right belongs to the wall that was found to its left.
TEST(LineFit, AWallBehindAPostIsOne) {
  OccupancyGrid grid = Grid();
  grid.NextScan();
  Row(&grid, {-1.2, 1}, 0, 2.41, 0.1);
  const std::vector<Point> hits{{-1.2, 1}, {-0.9, 1}, {-0.6, 1}, {-0.3, 0.4}, {0.3, 1}, {0.7, 1}, {1.2, 1}};
  EXPECT_EQ(Find(hits, grid).size(), 1U);
}

TEST(LineFit, NeverMoreEdgesThanThereIsRoomFor) {
  OccupancyGrid grid = Grid();
  grid.NextScan();
  auto hits = Row(&grid, {-1, 1}, 0, 2.01, 0.2);
  const auto down = Row(&grid, {1, 1}, -std::numbers::pi / 2, 2.01, 0.2);
  hits.insert(hits.end(), down.begin() + 1, down.end());
  std::vector<Edge> edges;
  edges.reserve(1);
  LineFit({}, grid.cell_m()).Find(hits, false, grid, &edges);
  EXPECT_EQ(edges.size(), 1U);
  EXPECT_EQ(edges.capacity(), 1U);
}

}  // namespace
}  // namespace cairn::local_map
