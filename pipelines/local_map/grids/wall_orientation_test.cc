#include "pipelines/local_map/grids/wall_orientation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace cairn::local_map {
namespace {

Edge At(double degrees, double length_m) {
  const double angle = RadOf(degrees);
  return {{0, 0},
          {length_m * std::cos(angle), length_m * std::sin(angle)},
          angle,
          RadOf(1 / std::pow(length_m, 1.5)),
          10};
}

TEST(WallOrientation, WallsAtSquareAnglesAreOneDirection) {
  WallOrientation orientation(0.9, {0.6, 1});
  EXPECT_FALSE(orientation.Dominant());
  for (int k = 0; k < 20; ++k) orientation.Add(std::vector{At(12, 2), At(102, 1), At(-78, 1), At(-168, 2)});
  ASSERT_TRUE(orientation.Dominant());
  EXPECT_NEAR(DegOf(orientation.Dominant()->angle_rad), 12, 1e-3);
  EXPECT_NEAR(orientation.Dominant()->strength, 1, 1e-5);
}

TEST(WallOrientation, IsNoneWhereNoDirectionIsStrong) {
  WallOrientation orientation(0.9, {0.6, 1});
  for (int k = 0; k < 40; ++k) orientation.Add(std::vector{At(11.25 * k, 1)});
  EXPECT_FALSE(orientation.Dominant());
}

TEST(WallOrientation, FollowsWhatIsSeenNow) {
  WallOrientation orientation(0.9, {0.6, 1});
  for (int k = 0; k < 100; ++k) orientation.Add(std::vector{At(0, 2)});
  int until = 0;
  for (int k = 1; k <= 40; ++k) {
    orientation.Add(std::vector{At(30, 2)});
    const auto found = orientation.Dominant();
    if (until == 0 && found && std::abs(DegOf(found->angle_rad) - 30) < 2) until = k;
  }
  EXPECT_GT(until, 5);
  EXPECT_LT(until, 30);
}

TEST(WallOrientation, CertainEdgesWeighMoreThanUncertainOnes) {
  WallOrientation orientation(0.9, {0.6, 1});
  for (int k = 0; k < 50; ++k) orientation.Add(std::vector{At(2, 3), At(30, 1), At(33, 1), At(36, 1)});
  ASSERT_TRUE(orientation.Dominant());
  EXPECT_NEAR(DegOf(orientation.Dominant()->angle_rad), 2, 0.1);
}

}  // namespace
}  // namespace cairn::local_map
