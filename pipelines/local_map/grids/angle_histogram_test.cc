#include "pipelines/local_map/grids/angle_histogram.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace cairn::local_map {
namespace {

constexpr double kHalfTurn_rad = std::numbers::pi;

TEST(AngleHistogram, OneAngleIsFoundExactlyWhereverItLies) {
  for (const double period : {kHalfTurn_rad, kHalfTurn_rad / 2}) {
    for (int k = -50; k <= 50; ++k) {
      const double angle = k * 0.1;
      AngleHistogram histogram;
      histogram.Add(angle, period, 2);
      const AnglePeak peak = PeakOf(histogram, period);
      EXPECT_NEAR(ModuloAngle(peak.angle_rad - angle, period), 0, 1e-6);
      EXPECT_NEAR(peak.strength, 1, 1e-6);
      EXPECT_NEAR(peak.weight, 2, 1e-6);
    }
  }
}

// By hand: period pi, bins of 22.5 degrees; 30 degrees is a third of the way from bin 1 to bin 2.
TEST(AngleHistogram, TheTwoNearestBinsShareAnAngle) {
  AngleHistogram histogram;
  histogram.Add(RadOf(30), kHalfTurn_rad, 3);
  EXPECT_NEAR(histogram.bin[1], 2, 1e-6);
  EXPECT_NEAR(histogram.bin[2], 1, 1e-6);
  histogram.Add(RadOf(30 - 180), kHalfTurn_rad, 3);
  EXPECT_NEAR(histogram.bin[1], 4, 1e-6);
  EXPECT_NEAR(histogram.Total(), 6, 1e-6);
}

TEST(AngleHistogram, WhatIsCommonToAllBinsDoesNotMoveThePeak) {
  AngleHistogram histogram;
  histogram.bin.fill(1);
  histogram.Add(RadOf(27), kHalfTurn_rad, 5);
  const AnglePeak peak = PeakOf(histogram, kHalfTurn_rad);
  EXPECT_NEAR(DegOf(peak.angle_rad), 27, 1e-4);
  EXPECT_NEAR(peak.strength, 8.0 / 13, 1e-6);
}

TEST(AngleHistogram, AllBinsAlikeArePeakOfThreeEighths) {
  AngleHistogram histogram;
  histogram.bin.fill(0.5F);
  EXPECT_NEAR(PeakOf(histogram, kHalfTurn_rad).strength, 3.0 / 8, 1e-6);
  EXPECT_TRUE(std::isfinite(PeakOf(histogram, kHalfTurn_rad).angle_rad));
  EXPECT_EQ(PeakOf({}, kHalfTurn_rad).strength, 0);
}

// However long ago its angles were added: all bins have decayed alike.
TEST(AngleHistogram, ThePeakIsThatOfTheShapeAlone) {
  AngleHistogram histogram;
  histogram.bin.fill(0.1F);
  histogram.Add(RadOf(50), kHalfTurn_rad, 3);
  histogram.Add(RadOf(-70), kHalfTurn_rad, 2);
  const AnglePeak before = PeakOf(histogram, kHalfTurn_rad);
  for (int k = 0; k < 4; ++k) {
    histogram.Scale(0.125);
    const AnglePeak peak = PeakOf(histogram, kHalfTurn_rad);
    EXPECT_NEAR(peak.angle_rad, before.angle_rad, 1e-6) << k;
    EXPECT_NEAR(peak.strength, before.strength, 1e-6) << k;
  }
}

TEST(AngleHistogram, ShiftMovesTheMeanAndKeepsTheWeight) {
  AngleHistogram histogram;
  histogram.Add(0.1, kHalfTurn_rad / 2, 3);
  histogram.Shift(-0.7, kHalfTurn_rad / 2);
  EXPECT_NEAR(ModuloAngle(PeakOf(histogram, kHalfTurn_rad / 2).angle_rad + 0.6, kHalfTurn_rad / 2), 0, 1e-6);
  EXPECT_NEAR(histogram.Total(), 3, 1e-6);
}

}  // namespace
}  // namespace cairn::local_map
