#include "datasets/simulate/walls.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "datasets/simulate/loop.h"
#include "datasets/simulate/sonar.h"

namespace cairn::datasets {
namespace {

CorridorWorld Loop(std::uint64_t seed) {
  Rng rng(seed, 0);
  return MakeLoopWorld(90, rng);
}

// One straight corridor of 10 m along x.
CorridorWorld Straight() { return {{{0, 0}, {10, 0}}, {"a", "b"}, {{1}, {0}}, 0}; }

// Shares nothing with the code under test: is a point within some corridor, its rectangle turned to its axis?
bool Free(const CorridorWorld& world, Point p) {
  for (const auto& [i, k] : world.Edges()) {
    const Point a = world.nodes[i], b = world.nodes[k];
    const double heading = std::atan2(b.y_m - a.y_m, b.x_m - a.x_m);
    const double dx = p.x_m - a.x_m, dy = p.y_m - a.y_m;
    const double along = std::cos(heading) * dx + std::sin(heading) * dy;
    const double across = std::cos(heading) * dy - std::sin(heading) * dx;
    if (along > -kCorridorHalfWidthM && along < DistanceM(a, b) + kCorridorHalfWidthM &&
        std::abs(across) < kCorridorHalfWidthM)
      return true;
  }
  return false;
}

constexpr double kMarchM = 0.005;

double March(const CorridorWorld& world, Point from, double heading, double most_m) {
  for (double travelled = 0; travelled < most_m; travelled += kMarchM) {
    if (!Free(world, {from.x_m + travelled * std::cos(heading), from.y_m + travelled * std::sin(heading)}))
      return travelled;
  }
  return most_m;
}

// By hand: walls at 2.2 m to either side and beyond the ends.
TEST(Walls, OfAStraightCorridorAreItsRectangle) {
  const std::vector<Wall> walls = WallsOf(Straight());
  EXPECT_EQ(walls.size(), 4U);
  EXPECT_NEAR(NearestWallM(walls, {3, 0.5}, 0, 0), 9.2, 1e-9);
  EXPECT_NEAR(NearestWallM(walls, {3, 0.5}, std::numbers::pi / 2, 0), 1.7, 1e-9);
  EXPECT_NEAR(NearestWallM(walls, {3, 0.5}, std::numbers::pi, 0), 5.2, 1e-9);
  EXPECT_NEAR(NearestWallM(walls, {3, 0.5}, std::numbers::pi / 3, 0), 1.7 / std::sin(std::numbers::pi / 3),
              1e-9);
  EXPECT_EQ(NearestWallM(walls, {30, 0}, 0, 0.1), std::numeric_limits<double>::infinity());
}

// A cone of 30 degrees to either side of 60 reaches the perpendicular to the side wall; one of 20 does not.
TEST(Walls, AConeHearsTheNearestPointInIt) {
  const std::vector<Wall> walls = WallsOf(Straight());
  const double degree = std::numbers::pi / 180;
  EXPECT_NEAR(NearestWallM(walls, {3, 0.5}, 60 * degree, 31 * degree), 1.7, 1e-9);
  EXPECT_NEAR(NearestWallM(walls, {3, 0.5}, 60 * degree, 20 * degree), 1.7 / std::sin(80 * degree), 1e-9);
}

TEST(Walls, RaysAgreeWithMarchingThroughTheCorridors) {
  int rays = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const CorridorWorld world = Loop(seed);
    const std::vector<Wall> walls = WallsOf(world);
    Rng rng(seed, 7);
    while (rays < static_cast<int>(40 * seed)) {
      const Point from{rng.Uniform(0, 90), rng.Uniform(0, 90)};
      if (!Free(world, from)) continue;
      const double heading = rng.Uniform(-3, 3);
      EXPECT_NEAR(std::min(20.0, NearestWallM(walls, from, heading, 0)), March(world, from, heading, 20),
                  2 * kMarchM)
          << seed << ": " << from.x_m << ' ' << from.y_m << ' ' << heading;
      ++rays;
    }
  }
  EXPECT_EQ(rays, 200);
}

TEST(Walls, ConesAreTheLeastOfTheirRays) {
  const CorridorWorld world = Loop(3);
  const std::vector<Wall> walls = WallsOf(world);
  Rng rng(3, 8);
  for (int i = 0; i < 50; ++i) {
    const Point node = world.nodes[rng.Below(world.nodes.size())];
    const double heading = rng.Uniform(-3, 3), half = 0.13;
    double least = 1e9;
    for (int k = -1000; k <= 1000; ++k)
      least = std::min(least, NearestWallM(walls, node, heading + half * k / 1000, 0));
    EXPECT_NEAR(NearestWallM(walls, node, heading, half), least, 0.01);
  }
}

// The whole way from the log: ranges against marching, over the cone, in the world that the seed makes.
TEST(Sonar, RangesAgreeWithAnIndependentRayCastOfTheTrueWorld) {
  SimulateLoopOptions options{.difficulty = "paper", .seed = 4};
  const Blob plain = SimulateLoop(options);
  options.sonar = true;
  const Blob log = SimulateLoop(options);
  const CorridorWorld world = Loop(4);
  const auto range = log.Get<double>("robot/0/sonar/range_m");
  const auto mount_x = log.Get<double>("robot/0/sonar/beam_x_m"),
             mount_y = log.Get<double>("robot/0/sonar/beam_y_m"),
             mount = log.Get<double>("robot/0/sonar/beam_heading_rad");
  const auto x = log.Get<double>("truth/robot/0/poses/x_m"), y = log.Get<double>("truth/robot/0/poses/y_m"),
             heading = log.Get<double>("truth/robot/0/poses/heading_rad");
  const double half = log.Scalar<double>("robot/0/sonar/opening_rad") / 2;
  const double most = log.Scalar<double>("robot/0/sonar/max_range_m");
  const std::size_t scans = log.at("robot/0/sonar/time_s").size(), beams = mount.size();
  ASSERT_EQ(beams, 24U);
  ASSERT_EQ(log.at("robot/0/sonar/range_m").shape(),
            (std::vector<std::int64_t>{static_cast<std::int64_t>(scans), 24}));
  ASSERT_EQ(log.Get<double>("robot/0/sonar/time_s")[7], log.Get<double>("truth/robot/0/poses/time_s")[8]);
  int heard = 0, silent = 0, lost = 0;
  double squares = 0;
  for (std::size_t s = 0; s < scans; s += 263) {
    for (std::size_t b = 0; b < beams; ++b) {
      const double h = heading[s + 1], c = std::cos(h), n = std::sin(h);
      const Point at{x[s + 1] + c * mount_x[b] - n * mount_y[b], y[s + 1] + n * mount_x[b] + c * mount_y[b]};
      double true_m = 1e9;
      for (int k = -5; k <= 5; ++k)
        true_m = std::min(true_m, March(world, at, h + mount[b] + half * k / 5, most + 1));
      const double measured = range[s * beams + b];
      if (!std::isnan(measured)) {
        EXPECT_NEAR(measured, true_m, 0.2) << s << ' ' << b;
        squares += (measured - true_m) * (measured - true_m);
        ++heard;
      } else {
        ++(true_m > most - 0.2 ? silent : lost);
      }
    }
  }
  EXPECT_GT(heard, 150);
  EXPECT_GT(silent, 5);
  EXPECT_NEAR(lost / static_cast<double>(heard), kSonarDropouts, 0.02);
  EXPECT_NEAR(std::sqrt(squares / heard), kSonarSdM, 0.015);
  // Nothing else is another for it.
  EXPECT_EQ(log.Sub("robot/0/observations/").ContentHash(), plain.Sub("robot/0/observations/").ContentHash());
  EXPECT_EQ(log.Sub("robot/0/odometry/").ContentHash(), plain.Sub("robot/0/odometry/").ContentHash());
}

TEST(Sonar, RobotsNeverTouchAWallAndTheTruthHoldsTheWalls) {
  for (const char* difficulty : {"paper", "base", "extreme"}) {
    SimulateLoopOptions options{.difficulty = difficulty, .seed = 11};
    options.sonar = true;
    const Blob log = SimulateLoop(options);
    const auto wx = log.Get<double>("truth/walls/x_m"), wy = log.Get<double>("truth/walls/y_m");
    const auto x = log.Get<double>("truth/robot/0/poses/x_m"), y = log.Get<double>("truth/robot/0/poses/y_m");
    ASSERT_GT(wx.size(), 80U);
    std::vector<Wall> walls;
    for (std::size_t i = 0; i < wx.size(); i += 2) walls.push_back({{wx[i], wy[i]}, {wx[i + 1], wy[i + 1]}});
    for (std::size_t i = 0; i < x.size(); i += 5) {
      for (int k = 0; k < 12; ++k)
        ASSERT_GT(NearestWallM(walls, {x[i], y[i]}, k * std::numbers::pi / 6, 0.27), 0.2)
            << difficulty << ' ' << i;
    }
  }
}

}  // namespace
}  // namespace cairn::datasets
