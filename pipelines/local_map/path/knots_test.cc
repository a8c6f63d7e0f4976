#include "pipelines/local_map/path/knots.h"

#include <gtest/gtest.h>

namespace cairn::local_map {
namespace {

std::vector<Sweep> Straight(int sweeps, int cut) {
  std::vector<Sweep> all;
  for (int s = 0; s < sweeps; ++s)
    all.push_back({0.2 * s, {0.1 * s, 0, 0}, 0.1 * s, s < cut ? 0 : 1, s == cut});
  return all;
}

TEST(Knots, BeginEachRunAndFollowTheWay) {
  const std::vector<std::size_t> knots = KnotsOf(Straight(31, 13), {.apart_m = 0.51});
  EXPECT_EQ(knots, (std::vector<std::size_t>{0, 6, 12, 13, 19, 25, 30}));
}

TEST(Knots, ALegAcrossAJumpIsOfLittleWorth) {
  const std::vector<Sweep> sweeps = Straight(31, 13);
  const std::vector<Leg> legs = LegsOf(sweeps, KnotsOf(sweeps, {}), 7, {});
  ASSERT_GT(legs.size(), 4U);
  EXPECT_EQ(legs[0].from, 7);
  EXPECT_LT(legs[0].along_m, 0.1);
  int wide = 0;
  for (const Leg& leg : legs) wide += leg.along_m > 1;
  EXPECT_EQ(wide, 1);
}

TEST(Knots, WhatMovesThemIsSharedOutOverTheWay) {
  std::vector<Sweep> sweeps = Straight(21, 100);
  const std::vector<std::size_t> knots{0, 10, 20};
  const std::vector<Point> placed{{0, 0}, {1, 0.5}, {2, 0.7}};
  MoveTo(knots, placed.data(), &sweeps);
  EXPECT_NEAR(sweeps[0].pose.y_m, 0, 1e-12);
  EXPECT_NEAR(sweeps[5].pose.y_m, 0.25, 1e-12);
  EXPECT_NEAR(sweeps[10].pose.y_m, 0.5, 1e-12);
  EXPECT_NEAR(sweeps[15].pose.y_m, 0.6, 1e-12);
  EXPECT_NEAR(sweeps[20].pose.y_m, 0.7, 1e-12);
}

}  // namespace
}  // namespace cairn::local_map
