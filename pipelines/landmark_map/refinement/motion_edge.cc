#include "pipelines/landmark_map/refinement/motion_edge.h"

#include <cmath>

namespace cairn::landmark_map {

MotionEdge Integral(std::span<const Control> controls, const SystematicErrors& errors) {
  enum { kX, kY, kHeading };
  enum { kDrift, kWay, kTurn };
  MotionEdge edge;
  Eigen::Vector3d& at = edge.motion;
  Eigen::Matrix3d& by = edge.derivative;
  for (const Control& control : controls) {
    const double half_m = 0.5 * std::abs(control.forward_m);
    at[kHeading] += (1.0 + errors.turn) * control.turn_rad - errors.drift_rad_per_m * half_m;
    by(kHeading, kTurn) += control.turn_rad;
    by(kHeading, kDrift) -= half_m;
    const double direction = at[kHeading] + control.aside_rad;
    const double cosine = std::cos(direction), sine = std::sin(direction);
    const double x = (1.0 + errors.way) * control.forward_m * cosine,
                 y = (1.0 + errors.way) * control.forward_m * sine;
    at[kX] += x;
    at[kY] += y;
    by.row(kX) -= y * by.row(kHeading);
    by.row(kY) += x * by.row(kHeading);
    by(kX, kWay) += control.forward_m * cosine;
    by(kY, kWay) += control.forward_m * sine;
    at[kHeading] -= errors.drift_rad_per_m * half_m;
    by(kHeading, kDrift) -= half_m;
  }
  return edge;
}

EdgeSpread SpreadOf(std::span<const Control> controls, const SystematicErrors& errors) {
  // No floor is even and no wheel round: a turn on the spot shifts the robot, and a way does so sideways.
  constexpr double kShift_m_per_sqrt_rad = 0.005, kSideways_m_per_sqrt_m = 0.002;
  constexpr double kLeast_m = 1e-4, kLeast_rad = 1e-5;
  EdgeSpread spread;
  double heading = 0.0, drifted = 0.0;
  for (std::size_t i = 0; i < controls.size(); ++i) {
    const Control& control = controls[i];
    const double length = std::abs(control.forward_m);
    const double half = 0.5 * errors.drift_rad_per_m * length;
    // What odometry counts for its drift, before this way and after the one before, no wheel has turned.
    const double said = control.turn_rad - drifted - half;
    const double turned = std::abs(i + 1 < controls.size() ? said : said - half);
    drifted = half;
    heading += (1.0 + errors.turn) * control.turn_rad - half;
    spread.turn(2, 2) += turned;
    const double ux = std::cos(heading + control.aside_rad), uy = std::sin(heading + control.aside_rad);
    const double x = control.forward_m * ux, y = control.forward_m * uy;
    const Eigen::Vector3d along(ux, uy, 0.0), across(-uy, ux, 0.0);
    // An error of the heading so far moves the end across.
    for (Eigen::Matrix3d* covariance : {&spread.walk, &spread.turn, &spread.way, &spread.slip}) {
      Eigen::Matrix3d carried = Eigen::Matrix3d::Identity();
      carried(0, 2) = -y;
      carried(1, 2) = x;
      *covariance = carried * *covariance * carried.transpose();
    }
    // A random walk of the heading along the way, and its integral.
    const Eigen::Vector3d side = control.forward_m * across;
    spread.walk += length / 3.0 * side * side.transpose();
    spread.walk.col(2) += 0.5 * length * side;
    spread.walk.row(2) += 0.5 * length * side.transpose();
    spread.walk(2, 2) += length;
    spread.way += length * along * along.transpose();
    spread.slip += kSideways_m_per_sqrt_m * kSideways_m_per_sqrt_m * length * across * across.transpose();
    spread.slip.topLeftCorner<2, 2>().diagonal().array() +=
        kShift_m_per_sqrt_rad * kShift_m_per_sqrt_rad * turned;
    heading -= half;
  }
  spread.slip.diagonal() +=
      Eigen::Vector3d(kLeast_m * kLeast_m, kLeast_m * kLeast_m, kLeast_rad * kLeast_rad);
  return spread;
}

}  // namespace cairn::landmark_map
