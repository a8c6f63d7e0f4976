#include "pipelines/landmark_map/refinement/motion_edge.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "pipelines/landmark_map/testing.h"

namespace cairn::landmark_map {
namespace {

const std::vector<Control> kControls{{0.3, 1.0},  {-0.1, 0.4}, {1.2, 0.0},
                                     {0.0, -0.7}, {0.05, 2.0}, {0.1, 0.5, 1.3}};

TEST(Integral, OfPerfectOdometryIsDeadReckoning) {
  const std::vector<Control> square(4, {std::numbers::pi / 2, 3.0});
  const MotionEdge edge = Integral(square, {});
  EXPECT_NEAR(edge.motion[0], 0.0, 1e-12);
  EXPECT_NEAR(edge.motion[1], 0.0, 1e-12);
  EXPECT_NEAR(edge.motion[2], 2.0 * std::numbers::pi, 1e-12);
}

// What it errs by in turns does not bend the way of a robot that goes aside and faces as before.
TEST(Integral, GoesAsideWithoutATurn) {
  const std::vector<Control> aside{{0.0, 2.0, std::numbers::pi / 2}};
  const MotionEdge edge = Integral(aside, {.turn = 0.1});
  EXPECT_NEAR(edge.motion[0], 0.0, 1e-12);
  EXPECT_NEAR(edge.motion[1], 2.0, 1e-12);
  EXPECT_EQ(edge.motion[2], 0.0);
  EXPECT_EQ(SpreadOf(aside, {}).turn.norm(), 0.0);
}

// Odometry that turns too far by 0.01 rad/m, and whose ways and turns are 5 and 10% short.
TEST(Integral, TakesTheDriftOffAndTheScalesIn) {
  std::vector<Control> said;
  for (const Control& control : kControls) {
    const double forward_m = control.forward_m / 1.05;
    said.push_back({(control.turn_rad + 0.01 * std::abs(forward_m)) / 1.1, forward_m, control.aside_rad});
  }
  const MotionEdge edge = Integral(said, {.drift_rad_per_m = 0.01, .way = 0.05, .turn = 0.1});
  const MotionEdge truth = Integral(kControls, {});
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(edge.motion[k], truth.motion[k], 0.03) << k;
  EXPECT_NEAR(edge.motion[2], truth.motion[2], 1e-12);
}

TEST(Integral, ItsDerivativeIsThatOfFiniteDifferences) {
  const SystematicErrors at{.drift_rad_per_m = 0.02, .way = 0.03, .turn = -0.04};
  const Eigen::Matrix3d derivative = Integral(kControls, at).derivative;
  constexpr double kStep = 1e-6;
  double SystematicErrors::* const unknowns[] = {&SystematicErrors::drift_rad_per_m, &SystematicErrors::way,
                                                 &SystematicErrors::turn};
  for (int k = 0; k < 3; ++k) {
    SystematicErrors above = at, below = at;
    above.*unknowns[k] += kStep;
    below.*unknowns[k] -= kStep;
    const Eigen::Vector3d slope =
        (Integral(kControls, above).motion - Integral(kControls, below).motion) / (2.0 * kStep);
    EXPECT_LT((slope - derivative.col(k)).norm(), 1e-7) << k;
  }
}

// Each control is cut into pieces, each of which errs by itself.
TEST(SpreadOf, IsTheScatterOfManyDrives) {
  constexpr double kWalk = 0.02, kTurn = 0.03, kWay = 0.04;
  constexpr int kPieces = 20, kDrives = 4000;
  Rng rng(11);
  const Eigen::Vector3d mean = Integral(kControls, {}).motion;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (int drive = 0; drive < kDrives; ++drive) {
    std::vector<Control> driven;
    for (const Control& control : kControls) {
      driven.push_back(
          {control.turn_rad + kTurn * std::sqrt(std::abs(control.turn_rad)) * rng.Normal(), 0.0});
      const double length = control.forward_m / kPieces, root = std::sqrt(std::abs(length));
      for (int piece = 0; piece < kPieces; ++piece) {
        driven.push_back({0.0, length + kWay * root * rng.Normal(), control.aside_rad});
        driven.push_back({kWalk * root * rng.Normal(), 0.0});
      }
    }
    const Eigen::Vector3d off = Integral(driven, {}).motion - mean;
    scatter += off * off.transpose() / kDrives;
  }
  const EdgeSpread spread = SpreadOf(kControls, {});
  const Eigen::Matrix3d expected =
      kWalk * kWalk * spread.walk + kTurn * kTurn * spread.turn + kWay * kWay * spread.way;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double scale = std::sqrt(expected(i, i) * expected(j, j));
      EXPECT_NEAR(scatter(i, j), expected(i, j), 0.08 * scale) << i << ' ' << j;
    }
  }
}

// A robot that goes straight on while its odometry drifts has no errors of turns, however the way is cut.
TEST(SpreadOf, OfWhatOdometryDriftsNoWheelHasTurned) {
  constexpr double kDrift = 0.03, kWay_m = 0.5;
  const Control whole{kDrift * kWay_m, kWay_m},
      arc[] = {{0.5 * kDrift * kWay_m, kWay_m}, {0.5 * kDrift * kWay_m, 0.0}};
  EXPECT_NEAR(SpreadOf({&whole, 1}, {.drift_rad_per_m = kDrift}).turn(2, 2), 0.0, 1e-12);
  EXPECT_NEAR(SpreadOf(arc, {.drift_rad_per_m = kDrift}).turn(2, 2), 0.0, 1e-12);
  EXPECT_NEAR(SpreadOf(arc, {}).turn(2, 2), kDrift * kWay_m, 1e-12);
  const std::vector<Control> rows(5, {kDrift * 0.1 * kWay_m, 0.1 * kWay_m});
  EXPECT_LT(SpreadOf(rows, {.drift_rad_per_m = kDrift}).turn(2, 2), 0.25 * 0.5 * kDrift * kWay_m);
  // What it turns besides counts in full.
  const std::vector<Control> bend(5, {(kDrift + 1.0) * 0.1 * kWay_m, 0.1 * kWay_m});
  EXPECT_NEAR(SpreadOf(bend, {.drift_rad_per_m = kDrift}).turn(2, 2), 0.5 * kWay_m, 1e-12);
}

}  // namespace
}  // namespace cairn::landmark_map
