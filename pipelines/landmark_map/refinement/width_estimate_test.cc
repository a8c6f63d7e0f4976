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
    for (int round = 0; round < 10 && ReestimateWidths(nominal, point, &problem) > 1.01; ++round)
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
    ReestimateWidths(nominal, point, &world.problem);
    point = Descend(world.problem, point).point;
  }
  EXPECT_LT(world.problem.widths[0].way_m_per_sqrt_m, 0.1);
  const std::vector<double> sigmas = EdgeSigmas(world.problem, point)[0];
  EXPECT_EQ(std::ranges::max_element(sigmas) - sigmas.begin(), 300);
  EXPECT_GT(sigmas[300], 9.0);
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
