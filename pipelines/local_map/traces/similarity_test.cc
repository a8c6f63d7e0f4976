#include "pipelines/local_map/traces/similarity.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "pipelines/local_map/testing/trace.h"

namespace cairn::local_map {
namespace {

constexpr SimilarityOptions kOptions;
constexpr auto kPi = std::numbers::pi_v<float>;

Side WallAt(float distance_m, float angle_rad = 0) {
  Side side;
  side.angle_rad.Include(angle_rad);
  side.distance_m.Include(distance_m);
  side.occupied = 1;
  return side;
}

Side DotAt(float distance_m) {
  Side side;
  side.nearest_m = distance_m;
  return side;
}

TEST(EdgeSimilarity, GoesFromOneForTheSameToMinusOneForSquareAngles) {
  EXPECT_EQ(EdgeSimilarity(WallAt(1), WallAt(2), kOptions), 1);
  EXPECT_NEAR(EdgeSimilarity(WallAt(1), WallAt(1, kPi / 8), kOptions), 0, 1e-6);
  EXPECT_EQ(EdgeSimilarity(WallAt(1), WallAt(1, kPi / 2), kOptions), -1);
}

TEST(EdgeSimilarity, TakesDirectionsModuloPi) {
  EXPECT_NEAR(EdgeSimilarity(WallAt(1, -kPi / 2), WallAt(1, kPi / 2), kOptions), 1, 1e-6);
}

TEST(EdgeSimilarity, OfOverlappingIntervalsIsOne) {
  Side wide = WallAt(1);
  wide.angle_rad.Include(0.6F);
  EXPECT_EQ(EdgeSimilarity(wide, WallAt(1, 0.5F), kOptions), 1);
}

TEST(Similarities, AreZeroWhereNothingIsKnown) {
  const Side none, wall = WallAt(1);
  EXPECT_EQ(EdgeSimilarity(none, wall, kOptions), 0);
  EXPECT_EQ(EdgeSimilarity(wall, none, kOptions), 0);
  EXPECT_EQ(SideSimilarity(wall, none, 0, kOptions), 0);
  EXPECT_EQ(SideSimilarity(none, wall, 0, kOptions), 0);
  EXPECT_EQ(WidthSimilarity({wall, none}, {wall, wall}, kOptions), 0);
  EXPECT_EQ(WidthSimilarity({wall, wall}, {none, wall}, kOptions), 0);
  EXPECT_EQ(CrossSimilarity(HandTrace(Corridor(), {}, 0, 9), none, 3, true, kOptions), 0);
}

TEST(WidthSimilarity, DoesNotDependOnWhereTheRobotIs) {
  const Feature recorded{WallAt(1), WallAt(1)};
  EXPECT_NEAR(WidthSimilarity(recorded, {WallAt(0.7F), WallAt(1.3F)}, kOptions), 1, 1e-5);
  EXPECT_LT(WidthSimilarity(recorded, {WallAt(1), WallAt(1.4F)}, kOptions), -0.9);
}

TEST(SideSimilarity, IsBestWhereTheRobotsShiftExplainsTheDistance) {
  EXPECT_NEAR(SideSimilarity(WallAt(1), WallAt(0.8F), 0.2, kOptions), 1, 1e-5);
  EXPECT_LT(SideSimilarity(WallAt(1), WallAt(0.8F), 0, kOptions), -0.9);
}

// Footnote 4 of [DM98].
TEST(Similarities, NegativeResultsFromOccupancyBecomeZero) {
  EXPECT_NEAR(SideSimilarity(WallAt(1), DotAt(1), 0, kOptions), 1, 1e-5);
  EXPECT_EQ(SideSimilarity(WallAt(1), DotAt(0.5F), 0, kOptions), 0);
  const Feature recorded{WallAt(1), WallAt(1)};
  EXPECT_NEAR(WidthSimilarity(recorded, {DotAt(1.2F), WallAt(0.8F)}, kOptions), 1, 1e-5);
  EXPECT_EQ(WidthSimilarity(recorded, {DotAt(0.4F), WallAt(0.8F)}, kOptions), 0);
}

TEST(DistanceSimilarity, ForgivesMoreWhereIntervalsAreWide) {
  EXPECT_NEAR(DistanceSimilarity(0.06, 0, 0, 0.06), 2 * std::exp(-0.5) - 1, 1e-6);
  EXPECT_GT(DistanceSimilarity(0.12, 0.4, 0, 0.06), DistanceSimilarity(0.12, 0, 0, 0.06));
}

TEST(CrossSimilarity, KnowsFractionsOfACell) {
  const EdgeTrace recorded = HandTrace(Corridor(), {}, -4, 31);  // edges at 2.0 and 3.1 m on the left
  Side now;
  now.cross_m = 0.03F;
  now.cross_cells = 1;
  EXPECT_NEAR(CrossSimilarity(recorded, now, (2.0 - 0.03) / 0.15, true, kOptions), 1, 1e-5);
  EXPECT_LT(CrossSimilarity(recorded, now, (2.2 - 0.03) / 0.15, true, kOptions), -0.9);
  EXPECT_NEAR(CrossSimilarity(recorded, now, 17, true, kOptions), kOptions.missing, 1e-6);
}

std::array<float, 8> Furniture() { return {1, 1, 1, 0, 1, 1, -1, -1}; }

TEST(Schemes, AverageIsSpoiledByFurnitureThatTheOthersResist) {
  std::array<float, 8> left = Furniture(), right{};
  const Total average = TotalOf(left, right, Scheme::kAverage, 0.3);
  EXPECT_EQ(average.known, 7);
  EXPECT_NEAR(average.mean(), 3.0 / 7, 1e-6);
  left = Furniture();
  const Total trimmed = TotalOf(left, right, Scheme::kTrimmed, 0.3);
  EXPECT_EQ(trimmed.known, 5);
  EXPECT_EQ(trimmed.mean(), 1);
}

// By hand: seven are known, and three tenths of them are two: the -1 of the left side, the -0.5 of the right
// one. What is left of both sides counts.
TEST(Schemes, TrimmedDropsTheWorstOfBothSidesAndCountsTheRestOfBoth) {
  std::array<float, 4> left{1, 0.5F, -1, 0.75F}, right{0.25F, -0.5F, 0, 1};
  const Total trimmed = TotalOf(left, right, Scheme::kTrimmed, 0.3);
  EXPECT_EQ(trimmed.known, 3 + 2);
  EXPECT_EQ(trimmed.sum, 1 + 0.5 + 0.75 + 0.25 + 1);
}

TEST(Schemes, BestSideIgnoresASideThatDoesNotFitWhereTheOtherDoes) {
  std::array<float, 3> left{0.5F, 0.5F, 0.5F}, right{-1, -1, 0};
  EXPECT_NEAR(TotalOf(left, right, Scheme::kBestSide, 0).sum, 1.5, 1e-6);
  std::array<float, 3> both{-0.5F, 0, 0}, worse{-1, -1, 0};
  EXPECT_NEAR(TotalOf(both, worse, Scheme::kBestSide, 0).sum, -2.5, 1e-6);
}

}  // namespace
}  // namespace cairn::local_map
