#include "schema/geometry.h"

#include <gtest/gtest.h>

#include <numbers>

namespace cairn {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(Geometry, AnglesAreWrappedToTheHalfOpenTurn) {
  EXPECT_DOUBLE_EQ(WrapAngle(0.5), 0.5);
  EXPECT_DOUBLE_EQ(WrapAngle(kPi), kPi);
  EXPECT_DOUBLE_EQ(WrapAngle(-kPi), kPi) << "the one end only";
  EXPECT_DOUBLE_EQ(WrapAngle(1.5 * kPi), -0.5 * kPi);
  EXPECT_NEAR(WrapAngle(0.25 - 20 * kPi), 0.25, 1e-12);
}

TEST(Geometry, AheadIsXAndTurnsAreCounterClockwise) {
  const Pose left = Compose({1, 2, kPi / 2}, {3, 1, kPi / 4});
  EXPECT_NEAR(left.x_m, 0, 1e-12);
  EXPECT_NEAR(left.y_m, 5, 1e-12);
  EXPECT_NEAR(left.heading_rad, 0.75 * kPi, 1e-12);
}

TEST(Geometry, BetweenUndoesCompose) {
  const Pose a{1, -2, 0.7}, b{-3, 0.5, 2.9}, back = Compose(a, Between(a, b));
  EXPECT_NEAR(back.x_m, b.x_m, 1e-12);
  EXPECT_NEAR(back.y_m, b.y_m, 1e-12);
  EXPECT_NEAR(back.heading_rad, b.heading_rad, 1e-12);
}

TEST(Geometry, RelativeIsBetweenWithAWrappedHeading) {
  const Pose seen = Relative({1, 1, 3}, {1, 3, -3});
  EXPECT_NEAR(seen.heading_rad, 2 * kPi - 6, 1e-12);
  EXPECT_NEAR(std::hypot(seen.x_m, seen.y_m), 2, 1e-12);
}

TEST(Geometry, InterpolationTurnsTheShorterWay) {
  const Pose middle = Interpolate({0, 0, kPi - 0.1}, {2, 4, -kPi + 0.3}, 0.5);
  EXPECT_NEAR(middle.x_m, 1, 1e-12);
  EXPECT_NEAR(middle.y_m, 2, 1e-12);
  EXPECT_NEAR(middle.heading_rad, -kPi + 0.1, 1e-12);
}

TEST(Geometry, DistancesAreEuclidean) { EXPECT_DOUBLE_EQ(DistanceM({1, 1}, {4, 5}), 5); }

TEST(GridBox, CellsBeginWhereTheyAreCountedFrom) {
  const GridBox box{-1, 2, 0.5, 4, 3};
  EXPECT_EQ(box.cells(), 12);
  EXPECT_EQ(box.ColumnOf(-1), 0);
  EXPECT_EQ(box.ColumnOf(-1.001), -1);
  EXPECT_EQ(box.RowOf(3.499), 2);
  EXPECT_FALSE(box.Holds(0, box.RowOf(3.5)));
  EXPECT_EQ(box.Index(1, 2), 9U);
  EXPECT_DOUBLE_EQ(box.Centre(3, 0).x_m, 0.75);
  EXPECT_DOUBLE_EQ(box.Centre(3, 0).y_m, 2.25);
}

TEST(GridBox, NoPlaceIsTooFarForAnIndex) {
  const GridBox box{0, 0, 1e-3, 1, 1};
  EXPECT_FALSE(box.Holds(box.ColumnOf(1e300), 0));
  EXPECT_FALSE(box.Holds(box.ColumnOf(-1e300), 0));
}

}  // namespace
}  // namespace cairn
