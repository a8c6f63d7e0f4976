// What a robot's controls say of the motion between two of its poses, as a function of what its odometry errs
// by all along: an edge of the least squares.
#pragma once

#include <Eigen/Core>
#include <span>

namespace cairn::landmark_map {

// First the turn, then the way.
struct Control {
  double turn_rad = 0.0, forward_m = 0.0;
  double aside_rad = 0.0;  // direction of the way, from the heading
};

// What one robot's odometry and its ranges err by in common. True motion is what odometry says, times 1 + way
// or 1 + turn, less the drift of its heading; a true distance is what its range says, less `range_m`.
struct SystematicErrors {
  double drift_rad_per_m = 0.0;
  double way = 0.0, turn = 0.0;
  double range_m = 0.0;
};

// From the frame of the first pose to the second one.
struct MotionEdge {
  Eigen::Vector3d motion = Eigen::Vector3d::Zero();      // x, y [m], heading [rad], not wrapped
  Eigen::Matrix3d derivative = Eigen::Matrix3d::Zero();  // of it, by drift, way and turn
};

// The exact integral of the controls; the drift turns half before each way and half after it.
MotionEdge Integral(std::span<const Control> controls, const SystematicErrors& errors);

// Covariance of an edge's motion, x, y, heading, by what makes it, of widths of one: a random walk of the
// heading of 1 rad/sqrt(m), errors of turns of 1 rad/sqrt(rad) and of ways of 1 m/sqrt(m). `slip` is there
// whatever the widths.
struct EdgeSpread {
  Eigen::Matrix3d walk = Eigen::Matrix3d::Zero(), turn = Eigen::Matrix3d::Zero(),
                  way = Eigen::Matrix3d::Zero(), slip = Eigen::Matrix3d::Zero();
};
EdgeSpread SpreadOf(std::span<const Control> controls, const SystematicErrors& errors);

}  // namespace cairn::landmark_map
