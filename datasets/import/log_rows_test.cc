#include "datasets/import/log_rows.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "datasets/import/name_index.h"
#include "schema/geometry.h"

namespace cairn::datasets {
namespace {

// Where the controls up to and including row `end` lead.
Pose EndOf(const Odometry& odometry, std::size_t end) {
  Pose pose;
  for (std::size_t i = 0; i < end; ++i) {
    pose.heading_rad += odometry.turn_rad[i];
    pose.x_m += odometry.forward_m[i] * std::cos(pose.heading_rad);
    pose.y_m += odometry.forward_m[i] * std::sin(pose.heading_rad);
  }
  return pose;
}

TEST(VelocityIntegrator, HalfOfATurnComesBeforeTheWayAndHalfAfter) {
  VelocityIntegrator integrator;
  Odometry odometry;
  integrator.Add(10, 2, 0.5, &odometry);
  integrator.Add(10.5, 0, 1, &odometry);
  integrator.Add(11.5, 3, 0, &odometry);
  integrator.Add(13.5, 9, 9, &odometry);
  EXPECT_EQ(odometry.time_s.vector(), (std::vector<double>{10, 10.5, 10.5, 11.5, 13.5}));
  EXPECT_EQ(odometry.turn_rad.vector(), (std::vector<double>{0, 0.125, 0.125, 1, 0}));
  EXPECT_EQ(odometry.forward_m.vector(), (std::vector<double>{0, 1, 0, 0, 6}));
  EXPECT_EQ(integrator.largest_gap_s(), 2);
}

TEST(VelocityIntegrator, FollowsACircleFromUnevenSteps) {
  // v = 0.4 m/s, omega = 0.2 rad/s: a circle of radius 2 m about (0, 2).
  VelocityIntegrator integrator;
  Odometry odometry;
  double time = 0;
  for (int i = 0; i <= 1000; ++i) {
    integrator.Add(time, 0.4, 0.2, &odometry);
    if (i < 1000) time += i % 3 == 0 ? 0.01 : 0.02;
  }
  const Pose end = EndOf(odometry, odometry.time_s.size());
  EXPECT_NEAR(end.heading_rad, 0.2 * time, 1e-9);
  EXPECT_NEAR(end.x_m, 2 * std::sin(0.2 * time), 1e-5);
  EXPECT_NEAR(end.y_m, 2 - 2 * std::cos(0.2 * time), 1e-5);
}

TEST(VelocityIntegrator, RepeatedTimesAddNothing) {
  VelocityIntegrator integrator;
  Odometry odometry;
  integrator.Add(1, 1, 0, &odometry);
  integrator.Add(2, 7, 0, &odometry);
  integrator.Add(2, 1, 0, &odometry);
  integrator.Add(3, 0, 0, &odometry);
  EXPECT_EQ(odometry.forward_m.vector(), (std::vector<double>{0, 1, 1}));
}

TEST(NormalizedAngle, KeepsWhatLiesWithinAndWrapsTheRest) {
  constexpr double kPi = std::numbers::pi;
  for (const double angle : {0.1, -3.0, kPi, -0.0}) EXPECT_EQ(NormalizedAngle(angle), angle);
  EXPECT_EQ(NormalizedAngle(-kPi), kPi);
  EXPECT_NEAR(NormalizedAngle(3 * kPi / 2), -kPi / 2, 1e-15);
  EXPECT_NEAR(NormalizedAngle(-7), 2 * kPi - 7, 1e-15);
}

TEST(NameIndex, SortsNumbersByValueAndNamesByTheirBytes) {
  NameIndex index;
  for (const char* name : {"10", "door", "9", "Door", "009", "0"}) index.FindOrAdd(name);
  EXPECT_EQ(index.FindOrAdd("9"), 2);
  EXPECT_EQ(index.Sort(), (std::vector<std::int32_t>{3, 5, 2, 4, 1, 0}));
  EXPECT_EQ(index.names(), (std::vector<std::string>{"0", "009", "9", "10", "Door", "door"}));
  EXPECT_EQ(index.Find("10"), 3);
  EXPECT_EQ(index.Find("none"), -1);
}

TEST(CheckNoise, NamesTheParameterThatCannotBe) {
  NoiseParameters noise;
  noise.contact_m = 0.3;
  CheckNoise(noise);
  noise.range_m = -1;
  EXPECT_THROW(CheckNoise(noise), InputError);
  noise.range_m = NAN;
  EXPECT_THROW(CheckNoise(noise), InputError);
}

TEST(CheckNoise, AShareIsAtMostOne) {
  NoiseParameters noise;
  noise.false_ratio = 0.02;
  noise.miss_ratio = 1;
  CheckNoise(noise);
  noise.false_ratio = 2;  // per cent
  EXPECT_THROW(CheckNoise(noise), InputError);
  noise.false_ratio = 0;
  noise.miss_ratio = 3;
  EXPECT_THROW(CheckNoise(noise), InputError);
}

TEST(CheckNoise, ASensorThatSeesNothingIsRefused) {
  NoiseParameters noise;
  noise.max_range_m = 0;
  EXPECT_THROW(CheckNoise(noise), InputError);
  noise.max_range_m = 0.1;
  for (const double allowed : {0.1, 2 * std::numbers::pi, 6.2832}) {
    noise.field_of_view_rad = allowed;
    CheckNoise(noise);
  }
  for (const double refused : {0.0, 6.4, 360.0}) {
    noise.field_of_view_rad = refused;
    EXPECT_THROW(CheckNoise(noise), InputError) << refused;
  }
}

TEST(FindMisreading, SaysWhatTheSensorCannotSee) {
  NoiseParameters noise;
  const auto reason = [&noise](double range_m, double bearing_rad) {
    const auto misreading = FindMisreading(range_m, bearing_rad, noise);
    return misreading ? misreading->reason : "";
  };
  EXPECT_EQ(reason(1e3, 3), "");
  EXPECT_EQ(reason(-1, 0), "negative range");
  noise.max_range_m = 5;
  noise.field_of_view_rad = 1.22;
  EXPECT_EQ(reason(5, 0.61), "");
  EXPECT_EQ(reason(5, -0.61), "");
  EXPECT_EQ(reason(5.1, 0), "beyond the sensor's maximum");
  EXPECT_EQ(reason(5, 0.611), "outside the sensor's field of view");
  EXPECT_EQ(reason(5, -0.611), "outside the sensor's field of view");
}

}  // namespace
}  // namespace cairn::datasets
