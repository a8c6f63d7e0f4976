#include "pipelines/landmark_map/refinement/least_squares.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "pipelines/landmark_map/refinement/testing.h"

namespace cairn::landmark_map {
namespace {

double PathRmse(const LeastSquaresPoint& point, const LeastSquaresPoint& truth) {
  double sum = 0.0;
  for (std::size_t k = 0; k < truth.nodes[0].size(); ++k)
    sum += (point.nodes[0][k] - truth.nodes[0][k]).head<2>().squaredNorm();
  return std::sqrt(sum / static_cast<double>(truth.nodes[0].size()));
}

TEST(Descend, FindsPathDriftAndScaleFromDeadReckoning) {
  const EightWorld world(3, 0.8 * kDegree, 1.04);
  const LeastSquaresEnd end = Descend(world.problem, world.Reckoned());
  EXPECT_TRUE(end.settled);
  EXPECT_LT(PathRmse(end.point, world.truth), 0.15);
  EXPECT_NEAR(end.point.errors[0].drift_rad_per_m, 0.8 * kDegree, 0.1 * kDegree);
  EXPECT_NEAR(end.point.errors[0].way, 1.0 / 1.04 - 1.0, 0.01);
  EXPECT_LT(end.cost, CostOf(world.problem, world.truth));
}

// Where it ends no unknown's small change costs less.
TEST(Descend, EndsWhereEveryDerivativeIsZero) {
  EightWorld world(4, 0.3 * kDegree, 1.0, 40);
  world.problem.priors.range_m = 0.1;
  LeastSquaresPoint end = world.Reckoned();
  for (int k = 0; k < 5; ++k) end = Descend(world.problem, end).point;
  const double least = CostOf(world.problem, end);
  const auto expect_least = [&](double* unknown, double by, const char* what, std::size_t k) {
    for (const double step : {by, -by}) {
      const double before = *unknown;
      *unknown += step;
      EXPECT_GT(CostOf(world.problem, end), least - 1e-4) << what << ' ' << k;
      *unknown = before;
    }
  };
  for (std::size_t k = 1; k < end.nodes[0].size(); ++k) {
    for (int i = 0; i < 3; ++i) expect_least(&end.nodes[0][k][i], i < 2 ? 0.01 : 0.002, "node", k);
  }
  for (std::size_t l = 0; l < 6; ++l) expect_least(&end.landmarks[l].x(), 0.01, "landmark", l);
  expect_least(&end.errors[0].drift_rad_per_m, 1e-4, "drift", 0);
  expect_least(&end.errors[0].way, 1e-3, "way", 0);
  expect_least(&end.errors[0].range_m, 0.01, "range", 0);
  expect_least(&end.errors[0].turn, 1e-3, "turn", 0);
}

// One in twenty of another landmark.
// Where ranges differ, their zero and the world's scale are told apart.
TEST(Descend, FindsWhatAllRangesAreTooLongBy) {
  EightWorld world(6, 0.2 * kDegree, 1.02);
  for (Sighting& seen : world.problem.sightings) {
    const double longer = 1.0 + 0.4 / std::hypot(seen.x_m, seen.y_m);
    seen.x_m *= longer;
    seen.y_m *= longer;
  }
  const LeastSquaresPoint without = Descend(world.problem, world.Reckoned()).point;
  EXPECT_EQ(without.errors[0].range_m, 0.0);
  EXPECT_GT(PathRmse(without, world.truth), 0.2);
  world.problem.priors.range_m = 0.1;
  const LeastSquaresPoint with = Descend(world.problem, world.Reckoned()).point;
  EXPECT_NEAR(with.errors[0].range_m, 0.4, 0.05);
  EXPECT_LT(PathRmse(with, world.truth), 0.1);
}

TEST(Descend, WrongIdentitiesHardlyCount) {
  EightWorld world(5, 0.3 * kDegree, 1.0);
  for (std::size_t k = 7; k < world.problem.sightings.size(); k += 20)
    world.problem.sightings[k].landmark = (world.problem.sightings[k].landmark + 2) % 6;
  EXPECT_LT(PathRmse(Descend(world.problem, world.truth).point, world.truth), 0.15);
}

}  // namespace
}  // namespace cairn::landmark_map
