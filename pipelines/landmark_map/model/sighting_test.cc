#include "pipelines/landmark_map/model/sighting.h"

#include <gtest/gtest.h>

#include "pipelines/landmark_map/state/settings.h"
#include "pipelines/landmark_map/testing.h"

namespace cairn::landmark_map {
namespace {

TEST(SightingNoise, IsWiderAcrossTheRayTheFartherOneSees) {
  const SightingNoise noise{.press_m = 0.4, .range_m = 0.3, .bearing_rad = 0.05};
  EXPECT_DOUBLE_EQ(noise.At(3.0, 4.0).along_m, 0.3);
  EXPECT_DOUBLE_EQ(noise.At(3.0, 4.0).across_m, 0.25);
  EXPECT_DOUBLE_EQ(noise.At(-30.0, 40.0).along_m, 0.3);
  EXPECT_DOUBLE_EQ(noise.At(-30.0, 40.0).across_m, 2.5);
  EXPECT_DOUBLE_EQ(noise.At(0.0, 0.0).along_m, 0.4);
  EXPECT_DOUBLE_EQ(noise.At(0.0, 0.0).across_m, 0.4);
}

// A log may say that its sensor never errs.
TEST(SightingNoise, IsNeverNothing) {
  const SightingNoise none{.press_m = 0.0, .range_m = 0.0, .bearing_rad = 0.0};
  for (const double x_m : {0.0, 5.0}) {
    EXPECT_DOUBLE_EQ(none.At(x_m, 0.0).along_m, 1e-3);
    EXPECT_DOUBLE_EQ(none.At(x_m, 0.0).across_m, 1e-3);
  }
}

TEST(SightingNoise, IsWhatTheLogStates) {
  Blob log = SquareLog{.ranged = true}.Make();
  EXPECT_DOUBLE_EQ(Resolve({}, log).sighting.range_m, 0.03 * 4.0) << "of the mean range: 10 m less 6";
  EXPECT_DOUBLE_EQ(Resolve({}, log).sighting.bearing_rad, 0.02);
  log.PutScalar<double>("noise/range_m", 0.5);
  log.PutScalar<double>("noise/bearing_rad", 0.07);
  const Settings settings = Resolve({}, log);
  EXPECT_DOUBLE_EQ(settings.sighting.range_m, 0.5);
  EXPECT_DOUBLE_EQ(settings.sighting.bearing_rad, 0.07);
  EXPECT_DOUBLE_EQ(Settings::FromBlob(settings.ToBlob()).sighting.bearing_rad, 0.07);
  Blob presses = SquareLog{}.Make();
  presses.PutScalar<double>("noise/press_m", 0.7);
  EXPECT_DOUBLE_EQ(Resolve({}, presses).sighting.press_m, 0.7);
}

}  // namespace
}  // namespace cairn::landmark_map
