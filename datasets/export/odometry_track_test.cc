#include "datasets/export/odometry_track.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "schema/rng.h"
#include "schema/square.h"

namespace cairn::datasets {
namespace {

kinds::Log::Odometry Controls(const std::vector<double>& time_s, const std::vector<Control>& controls) {
  kinds::Log::Odometry odometry;
  std::vector<double> turns, ways;
  for (const Control& control : controls) {
    turns.push_back(control.turn_rad);
    ways.push_back(control.forward_m);
  }
  odometry.time_s = time_s;
  odometry.turn_rad = turns;
  odometry.forward_m = ways;
  return odometry;
}

void ExpectPose(const Pose& pose, double x_m, double y_m, double heading_rad) {
  EXPECT_NEAR(pose.x_m, x_m, 1e-12);
  EXPECT_NEAR(pose.y_m, y_m, 1e-12);
  EXPECT_NEAR(pose.heading_rad, heading_rad, 1e-12);
}

constexpr double kQuarter_rad = std::numbers::pi / 2;

// A control turns at its beginning and then goes; the first one begins a second before it ends, as the
// others.
TEST(OdometryTrack, TakesOfAControlThatPartWhichLiesBetween) {
  const OdometryTrack track(Controls({1, 2, 3}, {{0, 1}, {kQuarter_rad, 2}, {kQuarter_rad, 3}}), {});
  ExpectPose(track.Between(0, 3).pose, 1 - 3, 2, 2 * kQuarter_rad);
  ExpectPose(track.Between(0.5, 1).pose, 0.5, 0, 0);
  ExpectPose(track.Between(1, 1.25).pose, 0, 0.5, kQuarter_rad);
  ExpectPose(track.Between(1.25, 2).pose, 1.5, 0, 0);
  ExpectPose(track.Between(3, 9).pose, 0, 0, 0);
  ExpectPose(track.Between(-5, 0).pose, 0, 0, 0);
}

TEST(OdometryTrack, ABentPathEndsWhereItShould) {
  const OdometryTrack track(Controls({1, 2, 3}, {{0.1, 1}, {-0.2, 2}, {0.4, 1}}), {});
  const Pose end{4.2, -0.3, 0.5};
  ExpectPose(track.BentTo(end, 0, 0, 3), 0, 0, 0);
  ExpectPose(track.BentTo(end, 0, 3, 3), 4.2, -0.3, 0.5);
  const Pose own = track.Between(0, 3).pose, middle = track.Between(0, 1.7).pose;
  ExpectPose(track.BentTo(own, 0, 1.7, 3), middle.x_m, middle.y_m, middle.heading_rad);
}

// Of 20,000 drives along a bent way whose errors are drawn as the model says: at each of the short pieces
// that a control is cut into the heading walks, and ways and turns err.
TEST(OdometryTrack, ItsCovarianceIsThatOfDrivesWithSuchErrors) {
  constexpr int kDrives = 20000, kPieces = 20;
  OdometryErrors errors;
  errors.walk_rad_per_sqrt_m = 0.05;
  errors.turn_rad_per_sqrt_rad = 0.04;
  errors.way_m_per_sqrt_m = 0.03;
  errors.distance_scale = 1.25;
  const std::vector<Control> controls{{0.3, 1}, {0.8, 2}, {-0.5, 1.5}};
  const OdometryMotion said = OdometryTrack(Controls({1, 2, 3}, controls), errors).Between(0, 3);
  Rng rng(5, 0, 0);
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  for (int drive = 0; drive < kDrives; ++drive) {
    Pose at;
    for (const Control& control : controls) {
      at.heading_rad += control.turn_rad +
                        errors.turn_rad_per_sqrt_rad * std::sqrt(std::abs(control.turn_rad)) * rng.Normal();
      for (int piece = 0; piece < kPieces; ++piece) {
        const double way_m = control.forward_m / kPieces;
        at.heading_rad += errors.walk_rad_per_sqrt_m * std::sqrt(way_m) * rng.Normal();
        const double gone_m =
            errors.distance_scale * (way_m + errors.way_m_per_sqrt_m * std::sqrt(way_m) * rng.Normal());
        at.x_m += gone_m * std::cos(at.heading_rad);
        at.y_m += gone_m * std::sin(at.heading_rad);
      }
    }
    const Eigen::Vector3d off(at.x_m - said.pose.x_m, at.y_m - said.pose.y_m,
                              at.heading_rad - said.pose.heading_rad);
    squares += off * off.transpose() / kDrives;
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j)
      EXPECT_NEAR(said.covariance(i, j), squares(i, j), 0.06 * std::sqrt(squares(i, i) * squares(j, j)))
          << i << " " << j;
  }
}

TEST(OdometryTrack, TheScaleOfAPathIsThatOfItsMotions) {
  const OdometryTrack track(Controls({1, 2, 3}, {{0.1, 1}, {-0.2, 2}, {0.4, 1}}), {});
  OdometryErrors half;
  half.distance_scale = 0.5;
  const OdometryTrack shorter(Controls({1, 2, 3}, {{0.1, 1}, {-0.2, 2}, {0.4, 1}}), half);
  std::vector<Pose> poses{{3, 4, 1}};
  for (const double time_s : {0.0, 1.0, 2.0})
    poses.push_back(Compose(poses.back(), shorter.Between(time_s, time_s + 1).pose));
  EXPECT_NEAR(track.ScaleOf({0, 1, 2, 3}, poses), 0.5, 1e-12);
  EXPECT_EQ(track.ScaleOf({5, 6}, {{0, 0, 0}, {1, 0, 0}}), 1);
}

TEST(OdometryTrack, NoControlsAreRefused) {
  EXPECT_THROW(OdometryTrack(Controls({}, {}), {}), InputError);
  EXPECT_THROW(OdometryTrack({}, {}), InputError);
}

}  // namespace
}  // namespace cairn::datasets
