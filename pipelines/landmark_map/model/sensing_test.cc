#include "pipelines/landmark_map/model/sensing.h"

#include <gtest/gtest.h>

#include "pipelines/landmark_map/state/settings.h"
#include "pipelines/landmark_map/testing.h"

namespace cairn::landmark_map {
namespace {

TEST(ObservationNoise, IsWiderAcrossTheRayTheFartherOneSees) {
  const ObservationNoise noise{.contact_m = 0.4, .range_m = 0.3, .bearing_rad = 0.05};
  EXPECT_DOUBLE_EQ(noise.At(3.0, 4.0).along_m, 0.3);
  EXPECT_DOUBLE_EQ(noise.At(3.0, 4.0).across_m, 0.25);
  EXPECT_DOUBLE_EQ(noise.At(-30.0, 40.0).along_m, 0.3);
  EXPECT_DOUBLE_EQ(noise.At(-30.0, 40.0).across_m, 2.5);
  EXPECT_DOUBLE_EQ(noise.At(0.0, 0.0).along_m, 0.4);
  EXPECT_DOUBLE_EQ(noise.At(0.0, 0.0).across_m, 0.4);
}

// A log may say that its sensor never errs.
TEST(ObservationNoise, IsNeverNothing) {
  const ObservationNoise none{.contact_m = 0.0, .range_m = 0.0, .bearing_rad = 0.0};
  for (const double x_m : {0.0, 5.0}) {
    EXPECT_DOUBLE_EQ(none.At(x_m, 0.0).along_m, 1e-3);
    EXPECT_DOUBLE_EQ(none.At(x_m, 0.0).across_m, 1e-3);
  }
}

TEST(ObservationNoise, IsWhatTheLogStates) {
  Blob log = SquareLog{.ranged = true}.Make();
  EXPECT_DOUBLE_EQ(Resolve({}, log).observation_noise.range_m, 0.03 * 4.0)
      << "of the mean range: 10 m less 6";
  EXPECT_DOUBLE_EQ(Resolve({}, log).observation_noise.bearing_rad, 0.02);
  log.PutScalar<double>("noise/range_m", 0.5);
  log.PutScalar<double>("noise/bearing_rad", 0.07);
  const Settings settings = Resolve({}, log);
  EXPECT_DOUBLE_EQ(settings.observation_noise.range_m, 0.5);
  EXPECT_DOUBLE_EQ(settings.observation_noise.bearing_rad, 0.07);
  EXPECT_DOUBLE_EQ(Settings::FromBlob(settings.ToBlob()).observation_noise.bearing_rad, 0.07);
  Blob contacts = SquareLog{}.Make();
  contacts.PutScalar<double>("noise/contact_m", 0.7);
  EXPECT_DOUBLE_EQ(Resolve({}, contacts).observation_noise.contact_m, 0.7);
}

}  // namespace
}  // namespace cairn::landmark_map
