#include "pipelines/localization/belief.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "schema/error.h"
#include "schema/rng.h"

namespace cairn::localization {
namespace {

double Sum(const std::vector<double>& values) { return std::reduce(values.begin(), values.end()); }

std::vector<Place> Line(std::size_t count, double step_m) {
  std::vector<Place> places;
  for (std::size_t k = 0; k < count; ++k) places.push_back({static_cast<double>(k) * step_m, 0.0});
  return places;
}

BeliefSpace EvenLine(std::size_t count, double step_m) {
  return {Line(count, step_m), std::vector<double>(count, 1.0)};
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
double Transition(const Place& from, const Place& to, const Place& displacement, double sd_m, double room) {
  const Place aim{from.x_m + displacement.x_m, from.y_m + displacement.y_m};
  return room * std::exp(-0.5 * std::pow(DistanceM(to, aim) / sd_m, 2));
}

// Table 1 against the sum over all paths that a robot may have taken through a world of six places.
TEST(TableOne, EqualsTheSumOverAllPaths) {
  Rng rng(2);
  std::vector<Place> places;
  std::vector<double> room;
  for (int k = 0; k < 6; ++k) {
    places.push_back({rng.Uniform(0, 2), rng.Uniform(0, 1)});
    room.push_back(rng.Uniform(0.5, 2));
  }
  const BeliefSpace space(places, room);
  const Motion motion{.sd_m = 0.8, .sd_ratio = 0.3};
  const Place moves[] = {{0.4, 0.1}, {0.6, -0.2}, {-0.3, 0.3}};
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
      probability *= Transition(places[at[t]], places[at[t + 1]], moves[t], sd_m, room[at[t + 1]]) *
                     likelihood[t][at[t + 1]];
    }
    expected[at[3]] += probability;
  }
  const double all = Sum(expected);
  // Beyond four standard deviations the product holds nothing.
  for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(belief[k], expected[k] / all, 1e-3);
  EXPECT_NEAR(Sum(belief), 1.0, 1e-12);
}

TEST(Move, ShiftsAndWidensByTheMotionModel) {
  const BeliefSpace space = EvenLine(400, 0.1);
  std::vector<double> belief(400, 0.0);
  belief[100] = 1.0;
  ASSERT_TRUE(space.Move({5.0, 0.0}, {.sd_m = 0.3, .sd_ratio = 0.08}, 0.0, &belief));
  const Estimate estimate = EstimateOf(space.places(), belief);
  EXPECT_NEAR(estimate.mean.x_m, 15.0, 1e-9);
  EXPECT_NEAR(estimate.mode.x_m, 15.0, 1e-9);
  EXPECT_NEAR(estimate.spread_m, 0.5, 1e-3);
}

// A robot that stands still must not drift to where more samples were taken.
TEST(Move, DoesNotPreferWherePlacesLieDensely) {
  std::vector<Place> places;
  for (int k = 0; k < 200; ++k) places.push_back({0.05 * k, 0.0});       // 10 m, 20 a metre
  for (int k = 0; k < 50; ++k) places.push_back({10.0 + 0.2 * k, 0.0});  // 10 m, 5 a metre
  const PlaceIndex index(places);
  std::vector<double> room;
  for (const Place& place : places) room.push_back(RoomOf(index, places, place, 0.3));
  const BeliefSpace space(places, room);
  const auto share = [](const std::vector<double>& belief) {
    return std::reduce(belief.begin(), belief.begin() + 200);
  };
  std::vector<double> belief = space.Anywhere();
  EXPECT_NEAR(share(belief), 0.5, 0.02);
  for (int t = 0; t < 20; ++t)
    ASSERT_TRUE(space.Move({0.0, 0.0}, {.sd_m = 0.3, .sd_ratio = 0.0}, 0.0, &belief));
  EXPECT_NEAR(share(belief), 0.5, 0.05);
}

TEST(Move, LosesWhatLeavesThePlaces) {
  const BeliefSpace space = EvenLine(50, 0.1);
  std::vector<double> belief(50, 0.0);
  belief[2] = belief[45] = 0.5;
  ASSERT_TRUE(space.Move({2.0, 0.0}, {.sd_m = 0.1, .sd_ratio = 0.0}, 0.0, &belief));
  EXPECT_NEAR(EstimateOf(space.places(), belief).mean.x_m, 2.2, 1e-3);
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
