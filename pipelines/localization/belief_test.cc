#include "pipelines/localization/belief.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "schema/error.h"
#include "schema/rng.h"

namespace cairn::localization {
namespace {

double Sum(const std::vector<double>& values) { return std::reduce(values.begin(), values.end()); }

std::vector<Position> Line(std::size_t count, double step_m) {
  std::vector<Position> positions;
  for (std::size_t k = 0; k < count; ++k) positions.push_back({static_cast<double>(k) * step_m, 0.0});
  return positions;
}

BeliefSpace EvenLine(std::size_t count, double step_m) {
  return {{Line(count, step_m), {}}, std::vector<double>(count, 1.0)};
}

TEST(Sense, IsBayesRule) {
  std::vector<double> belief = {0.5, 0.25, 0.25};
  ASSERT_TRUE(Sense({0.1, 0.4, 0.8}, &belief));
  EXPECT_NEAR(belief[0], 0.05 / 0.35, 1e-15);
  EXPECT_NEAR(belief[1], 0.10 / 0.35, 1e-15);
  EXPECT_NEAR(belief[2], 0.20 / 0.35, 1e-15);
}

TEST(Sense, LeavesTheBeliefWhereWhatIsSensedIsImpossible) {
  std::vector<double> belief = {0.5, 0.5, 0.0};
  EXPECT_FALSE(Sense({0.0, 0.0, 1.0}, &belief));
  EXPECT_EQ(belief, (std::vector<double>{0.5, 0.5, 0.0}));
}

// P(xi | xi~, a) as a matrix, by its definition.
double Transition(const Position& from, const Position& to, const Position& displacement, double sd_m,
                  double room) {
  const Position aim{from.x_m + displacement.x_m, from.y_m + displacement.y_m};
  return room * std::exp(-0.5 * std::pow(DistanceM(to, aim) / sd_m, 2));
}

// Table 1 against the sum over all paths that a robot may have taken through a world of six positions.
TEST(TableOne, EqualsTheSumOverAllPaths) {
  Rng rng(2);
  std::vector<Position> positions;
  std::vector<double> room;
  for (int k = 0; k < 6; ++k) {
    positions.push_back({rng.Uniform(0, 2), rng.Uniform(0, 1)});
    room.push_back(rng.Uniform(0.5, 2));
  }
  const BeliefSpace space({positions, {}}, room);
  const Motion motion{.sd_m = 0.8, .sd_ratio = 0.3};
  const Position moves[] = {{0.4, 0.1}, {0.6, -0.2}, {-0.3, 0.3}};
  std::vector<std::vector<double>> likelihood(3, std::vector<double>(6));
  for (auto& row : likelihood) {
    for (double& p : row) p = rng.Uniform();
  }

  std::vector<double> belief = space.Anywhere();
  for (int t = 0; t < 3; ++t) {
    ASSERT_TRUE(space.Move(moves[t], motion, 0.0, &belief));
    ASSERT_TRUE(Sense(likelihood[static_cast<std::size_t>(t)], &belief));
  }

  std::vector<double> expected(6, 0.0);
  for (int path = 0; path < 6 * 6 * 6 * 6; ++path) {
    const std::size_t at[] = {static_cast<std::size_t>(path % 6), static_cast<std::size_t>(path / 6 % 6),
                              static_cast<std::size_t>(path / 36 % 6), static_cast<std::size_t>(path / 216)};
    double probability = space.Anywhere()[at[0]];
    for (std::size_t t = 0; t < 3; ++t) {
      const double sd_m = std::hypot(0.8, 0.3 * std::hypot(moves[t].x_m, moves[t].y_m));
      probability *= Transition(positions[at[t]], positions[at[t + 1]], moves[t], sd_m, room[at[t + 1]]) *
                     likelihood[t][at[t + 1]];
    }
    expected[at[3]] += probability;
  }
  const double all = Sum(expected);
  // Beyond four standard deviations the product holds nothing.
  for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(belief[k], expected[k] / all, 1e-3);
  EXPECT_NEAR(Sum(belief), 1.0, 1e-12);
}

// The same of a robot that finds out its heading too: a path is of poses, each step from the heading where it
// is.
TEST(TableOne, EqualsTheSumOverAllPathsOfPosesToo) {
  Rng rng(3);
  Poses poses;
  for (int k = 0; k < 6; ++k) {
    poses.positions.push_back({rng.Uniform(0, 2), rng.Uniform(0, 1)});
    poses.heading_rad.push_back(rng.Uniform(-3, 3));
  }
  const BeliefSpace space(poses, std::vector<double>(6, 1.0));
  const Motion motion{.sd_m = 0.9, .sd_ratio = 0.0, .heading_sd_rad = 0.8};
  const OwnMotion moves[] = {{{0.4, 0.1}, 0.3}, {{0.6, -0.2}, -2.0}};
  std::vector<double> belief = space.Anywhere();
  for (const OwnMotion& own : moves) ASSERT_TRUE(space.Drive(own, motion, 0.0, &belief));
  std::vector<double> expected(6, 0.0);
  for (std::size_t path = 0; path < 6 * 6 * 6; ++path) {
    const std::size_t at[] = {path % 6, path / 6 % 6, path / 36};
    double probability = 1.0;
    for (std::size_t t = 0; t < 2; ++t) {
      const double heading = poses.heading_rad[at[t]], c = std::cos(heading), s = std::sin(heading);
      const Position& own = moves[t].moved;
      const Position moved{c * own.x_m - s * own.y_m, s * own.x_m + c * own.y_m};
      const double off =
          std::remainder(poses.heading_rad[at[t + 1]] - heading - moves[t].turn_rad, 2 * std::numbers::pi);
      probability *= Transition(poses.positions[at[t]], poses.positions[at[t + 1]], moved, 0.9, 1.0) *
                     std::exp(-0.5 * std::pow(off / 0.8, 2));
    }
    expected[at[2]] += probability;
  }
  const double all = Sum(expected);
  for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(belief[k], expected[k] / all, 1e-3) << k;
}

// Who drives half a metre forward is half a metre farther where it faces forward, and nearer where it faces
// back.
TEST(Drive, GoesWhereEachPositionFaces) {
  Poses poses;
  for (int k = 0; k < 100; ++k) {
    const int position = k / 2;
    poses.positions.push_back({0.1 * position, 0.0});
    poses.heading_rad.push_back(k % 2 == 0 ? 0.0 : std::numbers::pi);
  }
  const BeliefSpace space(poses, std::vector<double>(100, 1.0));
  std::vector<double> belief(100, 0.0);
  belief[40] = belief[41] = 0.5;  // at 2 m
  ASSERT_TRUE(
      space.Drive({{0.5, 0.0}, 0.0}, {.sd_m = 0.01, .sd_ratio = 0.0, .heading_sd_rad = 0.2}, 0.0, &belief));
  EXPECT_NEAR(belief[50], 0.5, 1e-6);
  EXPECT_NEAR(belief[31], 0.5, 1e-6);
  ASSERT_TRUE(space.KeepFacing(0.3, &belief));
  EXPECT_NEAR(belief[50], 1.0, 1e-6);
  const std::vector<double> before = belief;
  EXPECT_FALSE(space.KeepFacing(3.0, &belief));
  EXPECT_EQ(belief, before);
}

TEST(Room, IsThatAmongPositionsThatFaceAlike) {
  Poses poses{Line(20, 0.1), std::vector<double>(20, 0.0)};
  const PositionIndex index(poses.positions);
  const double one_way = RoomOf(index, poses, 10, 0.2);
  EXPECT_NEAR(SpacingM(index, poses), 0.1, 1e-12);
  for (std::size_t k = 1; k < 20; k += 2) poses.heading_rad[k] = 3.0;
  EXPECT_NEAR(RoomOf(index, poses, 10, 0.2), 2.0 * one_way, 0.02 * one_way);
  EXPECT_NEAR(SpacingM(index, poses), 0.2, 1e-12);
}

TEST(Move, ShiftsAndWidensByTheMotionModel) {
  const BeliefSpace space = EvenLine(400, 0.1);
  std::vector<double> belief(400, 0.0);
  belief[100] = 1.0;
  ASSERT_TRUE(space.Move({5.0, 0.0}, {.sd_m = 0.3, .sd_ratio = 0.08}, 0.0, &belief));
  const Estimate estimate = EstimateOf(space.positions(), belief);
  EXPECT_NEAR(estimate.mean.x_m, 15.0, 1e-9);
  EXPECT_NEAR(estimate.mode.x_m, 15.0, 1e-9);
  EXPECT_NEAR(estimate.spread_m, 0.5, 1e-3);
}

// A robot that stands still must not drift to where more samples were taken.
TEST(Move, DoesNotPreferWherePositionsLieDensely) {
  std::vector<Position> positions;
  for (int k = 0; k < 200; ++k) positions.push_back({0.05 * k, 0.0});       // 10 m, 20 a metre
  for (int k = 0; k < 50; ++k) positions.push_back({10.0 + 0.2 * k, 0.0});  // 10 m, 5 a metre
  const PositionIndex index(positions);
  std::vector<double> room;
  for (std::size_t k = 0; k < positions.size(); ++k) room.push_back(RoomOf(index, {positions, {}}, k, 0.3));
  const BeliefSpace space({positions, {}}, room);
  const auto share = [](const std::vector<double>& belief) {
    return std::reduce(belief.begin(), belief.begin() + 200);
  };
  std::vector<double> belief = space.Anywhere();
  EXPECT_NEAR(share(belief), 0.5, 0.02);
  for (int t = 0; t < 20; ++t)
    ASSERT_TRUE(space.Move({0.0, 0.0}, {.sd_m = 0.3, .sd_ratio = 0.0}, 0.0, &belief));
  EXPECT_NEAR(share(belief), 0.5, 0.05);
}

TEST(Move, LosesWhatLeavesThePositions) {
  const BeliefSpace space = EvenLine(50, 0.1);
  std::vector<double> belief(50, 0.0);
  belief[2] = belief[45] = 0.5;
  ASSERT_TRUE(space.Move({2.0, 0.0}, {.sd_m = 0.1, .sd_ratio = 0.0}, 0.0, &belief));
  EXPECT_NEAR(EstimateOf(space.positions(), belief).mean.x_m, 2.2, 1e-3);
  EXPECT_FALSE(space.Move({9.0, 0.0}, {.sd_m = 0.1, .sd_ratio = 0.0}, 0.0, &belief));
}

TEST(Move, WhatIsLostGoesAnywhere) {
  const BeliefSpace space = EvenLine(50, 0.1);
  std::vector<double> belief(50, 0.0);
  belief[10] = 1.0;
  std::vector<double> gone = belief;
  ASSERT_TRUE(space.Move({1.0, 0.0}, {.sd_m = 0.1, .sd_ratio = 0.0}, 0.25, &belief));
  EXPECT_NEAR(belief[49], 0.25 / 50, 1e-12);
  EXPECT_NEAR(Sum(belief), 1.0, 1e-12);
  ASSERT_TRUE(space.Move({100.0, 0.0}, {.sd_m = 0.1, .sd_ratio = 0.0}, 0.25, &gone));
  EXPECT_NEAR(gone[0], 1.0 / 50, 1e-12);
}

TEST(Near, IsTheWindowAndNothingElse) {
  const BeliefSpace space = EvenLine(50, 0.1);
  const std::vector<double> belief = space.Near({2.0, 0.0}, 0.25);
  for (std::size_t k = 0; k < 50; ++k) EXPECT_NEAR(belief[k], k >= 18 && k <= 22 ? 0.2 : 0.0, 1e-12) << k;
  EXPECT_THROW(space.Near({2.0, 9.0}, 1.0), InputError);
}

}  // namespace
}  // namespace cairn::localization
