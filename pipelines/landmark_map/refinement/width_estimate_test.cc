#include "pipelines/landmark_map/refinement/width_estimate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "pipelines/landmark_map/refinement/testing.h"

namespace cairn::landmark_map {
namespace {

// What a robot's heading errs by a root metre, all in all: an eight does not tell a walk from an error of
// turns.
double HeadingWidth(const LeastSquaresProblem& problem) {
  double way_m = 0.0, turns_rad = 0.0;
  for (const std::vector<Control>& controls : problem.robots[0].controls) {
    for (const Control& control : controls) {
      way_m += std::abs(control.forward_m);
      turns_rad += std::abs(control.turn_rad);
    }
  }
  const EdgeWidths& widths = problem.widths[0];
  return std::hypot(widths.walk_rad_per_sqrt_m, widths.turn_rad_per_sqrt_rad * std::sqrt(turns_rad / way_m));
}

// From far off, and without a bias over many worlds.
TEST(ReestimateWidths, AreThoseOfTheErrors) {
  constexpr int kWorlds = 12;
  double range_m = 0.0, bearing_rad = 0.0, heading = 0.0, way = 0.0;
  for (int k = 0; k < kWorlds; ++k) {
    const EightWorld world(1 + static_cast<std::uint64_t>(k), 0.1 * kDegree, 1.02, 600);
    LeastSquaresProblem nominal = world.problem;
    nominal.widths = {{1.5 * kDegree, 0.03, 0.05}};
    nominal.noise = {.contact_m = 0.3, .range_m = 0.3, .bearing_rad = 2.0 * kDegree};
    LeastSquaresProblem problem = nominal;
    LeastSquaresPoint point = Descend(problem, world.Reckoned()).point;
    for (int round = 0;
         round < 10 && ReestimateWidths({nominal.widths, nominal.noise}, point, &problem) > 1.01; ++round)
      point = Descend(problem, point).point;
    range_m += problem.noise.range_m / kWorlds;
    bearing_rad += problem.noise.bearing_rad / kWorlds;
    heading += HeadingWidth(problem) / kWorlds;
    way += problem.widths[0].way_m_per_sqrt_m / kWorlds;
  }
  EXPECT_NEAR(range_m, 0.1, 0.004);
  EXPECT_NEAR(bearing_rad, 1.0 * kDegree, 0.05 * kDegree);
  EXPECT_NEAR(heading, 0.5 * kDegree, 0.06 * kDegree);
  EXPECT_NEAR(way, 0.02, 0.003);
}

// Three metres that odometry counts and the robot did not go. Counted in full the width is 0.126, and they
// are 8 of it.
TEST(ReestimateWidths, OneMotionThatDoesNotFitWidensThemLess) {
  EightWorld world(2, 0.1 * kDegree, 1.02, 600);
  world.problem.robots[0].controls[300][0].forward_m += 3.0;
  const LeastSquaresProblem nominal = world.problem;
  LeastSquaresPoint point = Descend(world.problem, world.truth).point;
  for (int round = 0; round < 4; ++round) {
    ReestimateWidths({nominal.widths, nominal.noise}, point, &world.problem);
    point = Descend(world.problem, point).point;
  }
  EXPECT_LT(world.problem.widths[0].way_m_per_sqrt_m, 0.1);
  const std::vector<double> sigmas = EdgeSigmas(world.problem, point)[0];
  EXPECT_EQ(std::ranges::max_element(sigmas) - sigmas.begin(), 300);
  EXPECT_GT(sigmas[300], 9.0);
}

// Six times as far off, one sighting in `one_in`.
void Stray(int one_in, EightWorld* world) {
  for (std::size_t i = 0; i < world->problem.sightings.size(); i += static_cast<std::size_t>(one_in)) {
    Sighting& seen = world->problem.sightings[i];
    const Eigen::Vector3d& node = world->truth.nodes[0][static_cast<std::size_t>(seen.node)];
    const Eigen::Vector2d off =
        world->truth.landmarks[static_cast<std::size_t>(seen.landmark)] - node.head<2>();
    const double c = std::cos(node[2]), s = std::sin(node[2]);
    const Eigen::Vector2d there(c * off.x() + s * off.y(), c * off.y() - s * off.x());
    seen.x_m += 5.0 * (seen.x_m - there.x());
    seen.y_m += 5.0 * (seen.y_m - there.y());
  }
}

TEST(TailOf, IsAsHeavyAsTheSightingsShow) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    EightWorld world(seed, 0.0, 1.0);
    EXPECT_GE(TailOf(world.problem, world.truth), 6.0) << seed;
    Stray(20, &world);
    EXPECT_EQ(TailOf(world.problem, world.truth), kCauchySigmas) << seed;
  }
  EightWorld wide(1, 0.0, 1.0);
  wide.problem.noise = {.contact_m = 0.1, .range_m = 0.3, .bearing_rad = 3.0 * kDegree};
  EXPECT_GE(TailOf(wide.problem, wide.truth), 6.0) << "whatever widths are taken for";
  wide.problem.sightings.clear();
  EXPECT_EQ(TailOf(wide.problem, wide.truth), kCauchySigmas);
}

// The nodes with the widths that are found, and from then on with these tails; 0: with those that are found.
std::vector<Eigen::Vector3d> SettledNodes(const EightWorld& world, double tail_sigmas) {
  LeastSquaresProblem problem = world.problem;
  LeastSquaresEnd end = Descend(problem, world.truth);
  EXPECT_TRUE(SettleWidths({world.problem.widths, world.problem.noise}, &problem, &end));
  if (tail_sigmas > 0.0) problem.tail_sigmas = tail_sigmas;
  return Descend(problem, end.point, 50, 1e-7).point.nodes[0];
}

// They come out where plain least squares have them.
TEST(SettleWidths, WhatErrsAsGaussiansDoIsNotClipped) {
  double found = 0.0, clipped = 0.0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const EightWorld world(seed, 0.1 * kDegree, 1.02);
    const auto plain = SettledNodes(world, 1e4), as_found = SettledNodes(world, 0.0),
               as_clipped = SettledNodes(world, kCauchySigmas);
    for (std::size_t k = 0; k < plain.size(); ++k) {
      found += (as_found[k] - plain[k]).head<2>().squaredNorm();
      clipped += (as_clipped[k] - plain[k]).head<2>().squaredNorm();
    }
  }
  EXPECT_LT(found, 0.25 * clipped);
}

// Whatever widths the least squares begins with.
TEST(SettleWidths, ComeDownFromFarAbove) {
  const EightWorld world(3, 0.1 * kDegree, 1.02);
  const ExpectedWidths expected{world.problem.widths, world.problem.noise};
  std::vector<LeastSquaresProblem> settled;
  for (const double wide : {1.0, 5.0}) {
    LeastSquaresProblem& problem = settled.emplace_back(world.problem);
    problem.named = true;
    problem.widths[0].walk_rad_per_sqrt_m *= wide;
    problem.widths[0].turn_rad_per_sqrt_rad *= wide;
    LeastSquaresEnd end = Descend(problem, world.truth);
    ASSERT_TRUE(SettleWidths(expected, &problem, &end));
  }
  EXPECT_NEAR(HeadingWidth(settled[1]) / HeadingWidth(settled[0]), 1.0, 0.05);
  EXPECT_NEAR(settled[1].widths[0].way_m_per_sqrt_m / settled[0].widths[0].way_m_per_sqrt_m, 1.0, 0.08);
}

// Each sighting errs along its ray by what the one before did, but for a tenth.
TEST(RepeatsIn, TellsErrorsThatGoOn) {
  EightWorld world(7, 0.0, 1.0, 600);
  EXPECT_EQ(RepeatsIn(world.problem, world.truth).along, 1.0);
  std::array<double, 6> error{};
  Rng rng(1);
  for (Sighting& seen : world.problem.sightings) {
    double& own = error[static_cast<std::size_t>(seen.landmark)];
    own = 0.9 * own + std::sqrt(1.0 - 0.81) * 0.1 * rng.Normal();
    const Eigen::Vector3d& node = world.truth.nodes[0][static_cast<std::size_t>(seen.node)];
    const Eigen::Vector2d off =
        world.truth.landmarks[static_cast<std::size_t>(seen.landmark)] - node.head<2>();
    const double range = off.norm() + own,
                 bearing = std::atan2(off.y(), off.x()) - node[2] + kDegree * rng.Normal();
    seen.x_m = range * std::cos(bearing);
    seen.y_m = range * std::sin(bearing);
  }
  const SightingRepeats repeats = RepeatsIn(world.problem, world.truth);
  EXPECT_NEAR(repeats.along, 19.0, 6.0);
  EXPECT_EQ(repeats.across, 1.0);
}

}  // namespace
}  // namespace cairn::landmark_map
