#include "pipelines/local_map/path/scale_watch.h"

#include <gtest/gtest.h>

#include "pipelines/local_map/testing/corridor.h"

namespace cairn::local_map {
namespace {

// To and fro in a room of 6 by 5 m whose walls lie along the axes; odometry says `measured` of a metre.
double ScaleAfter(double measured, double noise_m) {
  const std::vector<TestWall> walls = TestBox(6, 5, {0, 0, 0});
  Rng rng(2);
  ScaleWatch watch({{RingBeams(), kTestOpeningRad, 6}});
  for (int drive = 0; drive < 8; ++drive) {
    for (int s = 0; s < 40; ++s) {
      const Pose truth{drive % 2 == 0 ? -1.6 + 0.08 * s : 1.6 - 0.08 * s, 0.2 * drive - 0.8,
                       drive % 2 == 0 ? 0 : M_PI};
      std::vector<double> ranges = SonarScan(walls, truth, 0, rng);
      for (double& range : ranges) range += noise_m * rng.Normal();
      const RingScan scan{0.2 * s, 0, ranges};
      watch.Update(s, {truth.x_m * measured, truth.y_m * measured, truth.heading_rad}, {&scan, 1});
    }
    watch.Finish();
  }
  EXPECT_GE(watch.approaches().size(), 8U);
  return FitScale(watch.approaches());
}

TEST(ScaleWatch, FindsHowLongOdometrysMetreIs) {
  for (const double measured : {0.97, 1.0, 1.04}) EXPECT_NEAR(ScaleAfter(measured, 0), 1 / measured, 0.006);
}

TEST(ScaleWatch, IsNotMoreThanAsSureAsItsReadings) { EXPECT_NEAR(ScaleAfter(0.97, 0.03), 1 / 0.97, 0.015); }

TEST(ScaleWatch, WithoutWallsSaysOne) {
  EXPECT_EQ(FitScale({}), 1);
  EXPECT_EQ(FitScale({{1, -1.5}, {1, -1.04}}), 1);  // too few
}

}  // namespace
}  // namespace cairn::local_map
