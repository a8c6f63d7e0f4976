#include "pipelines/landmark_map/refinement/least_squares.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "pipelines/landmark_map/testing.h"

namespace cairn::landmark_map {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// A robot on a figure of eight among six landmarks, of which it sees one from each node, and what its
// odometry says of that: too much turning by a drift, ways too long by a scale, and noise as the problem's
// widths have it.
struct EightWorld {
  LeastSquaresProblem problem;
  LeastSquaresPoint truth;

  EightWorld(std::uint64_t seed, double drift_rad_per_m, double scale, int nodes = 240) {
    constexpr double kStep_m = 0.5;
    Rng rng(seed);
    problem.widths = {{0.5 * kDegree, 0.01, 0.02}};
    problem.noise = {.contact_m = 0.1, .range_m = 0.1, .bearing_rad = 1.0 * kDegree};
    problem.priors = {1.0 * kDegree, 0.02, 0.02};
    problem.landmarks = 6;
    for (int l = 0; l < 6; ++l)
      truth.landmarks.emplace_back(12.0 * std::cos(l) + 3.0 * rng.Normal(), 8.0 * std::sin(2.0 * l));
    truth.errors = {{drift_rad_per_m, 1.0 / scale - 1.0, 0.0}};
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
    NodeTrack track;
    auto& path = truth.nodes.emplace_back();
    for (int k = 0; k < nodes; ++k) {
      if (k > 0) {
        const double turn = 0.12 * std::sin(2.0 * std::numbers::pi * k / 120.0);
        at[2] += turn;
        at[0] += kStep_m * std::cos(at[2]);
        at[1] += kStep_m * std::sin(at[2]);
        const double forward = kStep_m * scale + 0.02 * std::sqrt(kStep_m) * rng.Normal();
        track.controls.push_back(
            {{turn + drift_rad_per_m * kStep_m + 0.5 * kDegree * std::sqrt(kStep_m) * rng.Normal(),
              forward}});
      }
      track.time_s.push_back(k);
      path.push_back(at);
      const Eigen::Vector2d& landmark = truth.landmarks[static_cast<std::size_t>(k % 6)];
      const double range = (landmark - at.head<2>()).norm() + 0.1 * rng.Normal();
      const double bearing =
          std::atan2(landmark.y() - at[1], landmark.x() - at[0]) - at[2] + kDegree * rng.Normal();
      problem.sightings.push_back({0, k, k % 6, range * std::cos(bearing), range * std::sin(bearing)});
    }
    problem.robots = {track};
  }

  LeastSquaresPoint Reckoned() const {
    LeastSquaresPoint point = truth;
    point.errors = {{}};
    point.nodes[0] = DeadReckoned(problem.robots[0], truth.nodes[0][0], {});
    return point;
  }
};

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
  const EightWorld world(4, 0.3 * kDegree, 1.0, 40);
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
  expect_least(&end.errors[0].turn, 1e-3, "turn", 0);
}

// One in twenty of another landmark.
TEST(Descend, WrongIdentitiesHardlyCount) {
  EightWorld world(5, 0.3 * kDegree, 1.0);
  for (std::size_t k = 7; k < world.problem.sightings.size(); k += 20)
    world.problem.sightings[k].landmark = (world.problem.sightings[k].landmark + 2) % 6;
  EXPECT_LT(PathRmse(Descend(world.problem, world.truth).point, world.truth), 0.15);
}

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

// Squares of the errors of the landmarks and of one pose in units of their covariances, in the frame of the
// found landmarks: the true ones are laid over them.
struct Squares {
  double landmarks = 0.0, pose = 0.0;  // a landmark's in the mean
};
Squares SquaresOf(const EightWorld& world, const LeastSquaresPoint& found,
                  const LeastSquaresCovariances& covariances) {
  Eigen::Vector2d mean_true = Eigen::Vector2d::Zero(), mean_found = mean_true;
  for (std::size_t l = 0; l < 6; ++l) {
    mean_true += world.truth.landmarks[l] / 6.0;
    mean_found += found.landmarks[l] / 6.0;
  }
  double dot = 0.0, cross = 0.0;
  for (std::size_t l = 0; l < 6; ++l) {
    const Eigen::Vector2d a = world.truth.landmarks[l] - mean_true, b = found.landmarks[l] - mean_found;
    dot += a.dot(b);
    cross += a.x() * b.y() - a.y() * b.x();
  }
  const double turn = std::atan2(cross, dot), c = std::cos(turn), s = std::sin(turn);
  const auto laid = [&](const Eigen::Vector2d& p) -> Eigen::Vector2d {
    const Eigen::Vector2d a = p - mean_true;
    return mean_found + Eigen::Vector2d(c * a.x() - s * a.y(), s * a.x() + c * a.y());
  };
  Squares squares;
  for (std::size_t l = 0; l < 6; ++l) {
    const Eigen::Vector2d off = laid(world.truth.landmarks[l]) - found.landmarks[l];
    squares.landmarks += off.dot(covariances.landmarks[l].inverse() * off) / 6.0;
  }
  const std::size_t node = 60;
  Eigen::Vector3d off;
  off << laid(world.truth.nodes[0][node].head<2>()) - found.nodes[0][node].head<2>(),
      world.truth.nodes[0][node][2] + turn - found.nodes[0][node][2];
  squares.pose = off.dot(covariances.nodes[0][node].inverse() * off);
  return squares;
}

// Over many worlds as large as their covariances say: two a landmark, three a pose.
TEST(CovariancesOf, AreThoseOfTheErrorsInTheLandmarksFrame) {
  constexpr int kWorlds = 60;
  Squares mean;
  for (int k = 0; k < kWorlds; ++k) {
    const EightWorld world(100 + static_cast<std::uint64_t>(k), 0.3 * kDegree, 1.02, 120);
    const LeastSquaresPoint found = Descend(world.problem, world.truth).point;
    const LeastSquaresCovariances covariances = CovariancesOf(world.problem, found);
    ASSERT_EQ(covariances.landmarks.size(), 6U);
    const Squares squares = SquaresOf(world, found, covariances);
    mean.landmarks += squares.landmarks / kWorlds;
    mean.pose += squares.pose / kWorlds;
  }
  EXPECT_NEAR(mean.landmarks, 2.0, 0.35);
  EXPECT_NEAR(mean.pose, 3.0, 1.0);
}

// A landmark is seen too near or too far by as much each time. Were each sighting's error its own, the
// landmarks would be off by far more than the covariances say.
TEST(CovariancesOf, CountWhatALandmarksSightingsErrByInCommon) {
  constexpr int kWorlds = 40;
  double considered = 0.0, each_its_own = 0.0;
  for (int k = 0; k < kWorlds; ++k) {
    EightWorld world(300 + static_cast<std::uint64_t>(k), 0.3 * kDegree, 1.02, 360);
    Rng rng(static_cast<std::uint64_t>(k));
    std::array<double, 6> common{};
    for (double& error : common) error = 0.1 * std::sqrt(0.8) * rng.Normal();
    for (Sighting& seen : world.problem.sightings) {
      const Eigen::Vector2d way = world.truth.landmarks[static_cast<std::size_t>(seen.landmark)] -
                                  world.truth.nodes[0][static_cast<std::size_t>(seen.node)].head<2>();
      const double range =
          way.norm() + common[static_cast<std::size_t>(seen.landmark)] + 0.1 * std::sqrt(0.2) * rng.Normal();
      const double bearing = std::atan2(seen.y_m, seen.x_m);
      seen.x_m = range * std::cos(bearing);
      seen.y_m = range * std::sin(bearing);
    }
    LeastSquaresPoint found = Descend(world.problem, world.truth).point;
    each_its_own += SquaresOf(world, found, CovariancesOf(world.problem, found)).landmarks / kWorlds;
    world.problem.repeats = {9.0, 1.0};  // of a correlation of 0.8
    found = Descend(world.problem, found).point;
    considered += SquaresOf(world, found, CovariancesOf(world.problem, found)).landmarks / kWorlds;
  }
  EXPECT_GT(each_its_own, 5.0);
  EXPECT_NEAR(considered, 1.8, 0.6);
}

}  // namespace
}  // namespace cairn::landmark_map
