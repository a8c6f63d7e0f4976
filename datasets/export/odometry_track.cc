#include "datasets/export/odometry_track.h"

#include <algorithm>
#include <cmath>

#include "schema/square.h"

namespace cairn::datasets {
namespace {

// The first control begins as long before it ends as controls usually take.
double UsualControl_s(const std::vector<double>& time_s) {
  std::vector<double> lengths_s;
  for (std::size_t i = 1; i < time_s.size(); ++i)
    if (time_s[i] > time_s[i - 1]) lengths_s.push_back(time_s[i] - time_s[i - 1]);
  if (lengths_s.empty()) return 1;
  const auto middle = lengths_s.begin() + static_cast<std::ptrdiff_t>(lengths_s.size() / 2);
  std::ranges::nth_element(lengths_s, middle);
  return *middle;
}

// How much of its motion these are: turns count where the robot stands.
double EffortOf(const std::vector<Control>& controls) {
  constexpr double kTurn_m_per_rad = 0.01;
  double effort = 0;
  for (const Control& control : controls)
    effort += std::abs(control.forward_m) + kTurn_m_per_rad * std::abs(control.turn_rad);
  return effort;
}

}  // namespace

OdometryTrack::OdometryTrack(const kinds::Log::Odometry& odometry, const OdometryErrors& errors)
    : errors_(errors) {
  const std::vector<double> time_s = odometry.time_s.vector();
  if (time_s.empty()) throw InputError("the log has no odometry ('" + odometry.time_s.name() + "' is empty)");
  time_s_ = {time_s.front() - UsualControl_s(time_s)};
  time_s_.insert(time_s_.end(), time_s.begin(), time_s.end());
  for (std::size_t i = 0; i < time_s.size(); ++i)
    controls_.push_back({odometry.turn_rad[i], odometry.forward_m[i]});
}

std::vector<Control> OdometryTrack::ControlsBetween(double from_s, double to_s) const {
  std::vector<Control> controls;
  const auto after = std::ranges::upper_bound(time_s_, from_s) - time_s_.begin();
  for (auto i = static_cast<std::size_t>(std::max<std::ptrdiff_t>(after, 1));
       i < time_s_.size() && (time_s_[i] <= to_s || time_s_[i - 1] < to_s); ++i) {
    const double length_s = time_s_[i] - time_s_[i - 1];
    const double within_s = std::min(to_s, time_s_[i]) - std::max(from_s, time_s_[i - 1]);
    const Control& whole = controls_[i - 1];
    controls.push_back({from_s <= time_s_[i - 1] ? whole.turn_rad : 0,
                        length_s > 0 ? within_s / length_s * whole.forward_m : whole.forward_m});
  }
  return controls;
}

OdometryMotion OdometryTrack::Integral(const std::vector<Control>& controls) const {
  // No floor is even and no wheel round: a turn on the spot shifts the robot, and a way does so sideways.
  constexpr double kShift_m_per_sqrt_rad = 0.005, kSideways_m_per_sqrt_m = 0.002;
  constexpr double kLeast_m = 1e-4, kLeast_rad = 1e-5;
  OdometryMotion motion;
  Pose& at = motion.pose;
  Eigen::Matrix3d& covariance = motion.covariance;
  double drifted = 0;
  for (std::size_t i = 0; i < controls.size(); ++i) {
    const Control& control = controls[i];
    const double length = std::abs(control.forward_m);
    // The drift turns half before the way and half after it.
    const double half = 0.5 * errors_.drift_rad_per_m * length;
    // What odometry counts for its drift, before this way and after the one before, no wheel has turned.
    const double said = control.turn_rad - drifted - half;
    const double turned = std::abs(i + 1 < controls.size() ? said : said - half);
    drifted = half;
    covariance(2, 2) += Square(errors_.turn_rad_per_sqrt_rad) * turned;
    at.heading_rad += errors_.turn_scale * control.turn_rad - half;
    const Eigen::Vector3d along(std::cos(at.heading_rad), std::sin(at.heading_rad), 0);
    const Eigen::Vector3d across(-along.y(), along.x(), 0);
    // An error of the heading so far moves the end across.
    const Eigen::Vector3d side = control.forward_m * across;
    Eigen::Matrix3d carried = Eigen::Matrix3d::Identity();
    carried.col(2) += side;
    covariance = (carried * covariance * carried.transpose()).eval();
    // A random walk of the heading along the way, and its integral.
    const double walk = Square(errors_.walk_rad_per_sqrt_m) * length;
    covariance += walk / 3 * side * side.transpose();
    covariance.col(2) += walk / 2 * side;
    covariance.row(2) += walk / 2 * side.transpose();
    covariance(2, 2) += walk;
    covariance += Square(errors_.way_m_per_sqrt_m) * length * along * along.transpose();
    covariance += Square(kSideways_m_per_sqrt_m) * length * across * across.transpose();
    covariance.diagonal().head<2>().array() += Square(kShift_m_per_sqrt_rad) * turned;
    at.x_m += errors_.distance_scale * control.forward_m * along.x();
    at.y_m += errors_.distance_scale * control.forward_m * along.y();
    at.heading_rad -= half;
  }
  covariance.diagonal() += Eigen::Vector3d(Square(kLeast_m), Square(kLeast_m), Square(kLeast_rad));
  // Odometry errs in its own metres.
  const Eigen::Vector3d metres(errors_.distance_scale, errors_.distance_scale, 1);
  covariance = (metres.asDiagonal() * covariance * metres.asDiagonal()).eval();
  return motion;
}

OdometryMotion OdometryTrack::Between(double from_s, double to_s) const {
  return Integral(ControlsBetween(from_s, to_s));
}

Pose OdometryTrack::BentTo(const Pose& end, double from_s, double at_s, double to_s) const {
  const std::vector<Control> until = ControlsBetween(from_s, at_s), all = ControlsBetween(from_s, to_s);
  const Pose there = Integral(until).pose, whole = Integral(all).pose;
  const double effort = EffortOf(all);
  const double part = effort > 0 ? std::clamp(EffortOf(until) / effort, 0.0, 1.0) : 0;
  // The heading's error bends the way as it comes; what else is missing in the end shifts it.
  const double turn = WrapAngle(end.heading_rad - whole.heading_rad);
  const Pose bent_end = Compose({0, 0, turn / 2}, whole);
  Pose bent = Compose({0, 0, part * turn / 2}, there);
  bent.x_m += part * (end.x_m - bent_end.x_m);
  bent.y_m += part * (end.y_m - bent_end.y_m);
  bent.heading_rad = there.heading_rad + part * turn;
  return bent;
}

double OdometryTrack::ScaleOf(const std::vector<double>& time_s, const std::vector<Pose>& poses) const {
  double products = 0, squares = 0;
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    const Pose own = cairn::Between(poses[i], poses[i + 1]), said = Between(time_s[i], time_s[i + 1]).pose;
    products += own.x_m * said.x_m + own.y_m * said.y_m;
    squares += Square(said.x_m) + Square(said.y_m);
  }
  return squares > 0 && products > 0 ? products / squares : 1;
}

}  // namespace cairn::datasets
