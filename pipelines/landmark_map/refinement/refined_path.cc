#include "pipelines/landmark_map/refinement/refined_path.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cairn::landmark_map {
namespace {

// How much of its way a robot has gone: that of turns counts where it stands.
double Effort(std::span<const Control> controls) {
  constexpr double kTurn_m_per_rad = 0.01;
  double effort = 0.0;
  for (const Control& control : controls)
    effort += std::abs(control.forward_m) + kTurn_m_per_rad * std::abs(control.turn_rad);
  return effort;
}

Eigen::Vector2d Rotated(const Eigen::Vector2d& v, double angle_rad) {
  const double cosine = std::cos(angle_rad), sine = std::sin(angle_rad);
  return {cosine * v.x() - sine * v.y(), sine * v.x() + cosine * v.y()};
}

bool SameWay(double a, double b) { return (a >= 0.0) == (b >= 0.0); }

// The same motion in fewer controls: those of a short arc become half its turn, its way, and the other half,
// which is wrong by a turn squared 24th of the way.
std::vector<Control> JoinedArcs(std::span<const Control> controls) {
  constexpr double kMostTurn_rad = 0.05, kMostWay_m = 0.1;
  std::vector<Control> joined;
  for (std::size_t i = 0; i < controls.size();) {
    Control arc = controls[i++];
    const std::size_t first = i;
    for (; i < controls.size(); ++i) {
      const Control& next = controls[i];
      if (next.aside_rad != arc.aside_rad || !SameWay(next.turn_rad, arc.turn_rad) ||
          !SameWay(next.forward_m, arc.forward_m) || std::abs(arc.turn_rad + next.turn_rad) > kMostTurn_rad ||
          std::abs(arc.forward_m + next.forward_m) > kMostWay_m)
        break;
      arc = {arc.turn_rad + next.turn_rad, arc.forward_m + next.forward_m, arc.aside_rad};
    }
    if (i == first) {
      joined.push_back(arc);
    } else {
      joined.push_back({0.5 * arc.turn_rad, arc.forward_m, arc.aside_rad});
      joined.push_back({0.5 * arc.turn_rad, 0.0});
    }
  }
  return joined;
}

}  // namespace

std::vector<Control> ControlsBetween(const Odometry& odometry, double from_s, double to_s) {
  const std::vector<double>& time = odometry.time_s;
  std::vector<Control> controls;
  for (std::size_t i = static_cast<std::size_t>(std::ranges::upper_bound(time, from_s) - time.begin());
       i < time.size() && (time[i] <= to_s || (i > 0 && time[i - 1] < to_s)); ++i) {
    if (i == 0) continue;
    const double heading = odometry.heading_rad[i], direction = heading + odometry.aside_rad[i];
    const double forward = (odometry.x_m[i] - odometry.x_m[i - 1]) * std::cos(direction) +
                           (odometry.y_m[i] - odometry.y_m[i - 1]) * std::sin(direction);
    const double length_s = time[i] - time[i - 1];
    const double begin_s = std::max(from_s, time[i - 1]), end_s = std::min(to_s, time[i]);
    const double part = length_s > 0.0 ? (end_s - begin_s) / length_s : 1.0;
    const bool turns = from_s <= time[i - 1];
    const Control control{turns ? heading - odometry.heading_rad[i - 1] : 0.0, part * forward,
                          odometry.aside_rad[i]};
    if (control.turn_rad != 0.0 || control.forward_m != 0.0) controls.push_back(control);
  }
  return controls;
}

NodeTrack TrackThrough(const Odometry& odometry, std::span<const double> times_s, std::vector<int>* node_of) {
  NodeTrack track;
  track.time_s = {odometry.time_s.front()};
  const auto go_on = [&](double time_s) {
    const std::vector<Control> controls = ControlsBetween(odometry, track.time_s.back(), time_s);
    if (controls.empty()) return;
    track.controls.push_back(JoinedArcs(controls));
    track.time_s.push_back(time_s);
  };
  node_of->clear();
  for (const double time_s : times_s) {
    go_on(std::min(time_s, odometry.time_s.back()));
    node_of->push_back(static_cast<int>(track.time_s.size()) - 1);
  }
  go_on(odometry.time_s.back());
  return track;
}

RefinedPath::RefinedPath(Odometry odometry, NodeTrack track, std::vector<Eigen::Vector3d> nodes,
                         std::vector<Eigen::Matrix3d> covariances, SystematicErrors errors, EdgeWidths widths)
    : odometry_(std::move(odometry)),
      track_(std::move(track)),
      nodes_(std::move(nodes)),
      covariances_(std::move(covariances)),
      errors_(errors),
      widths_(widths) {}

RefinedPath::Pose RefinedPath::At(double time_s) const {
  const auto after = std::ranges::upper_bound(track_.time_s, time_s) - track_.time_s.begin();
  const auto k = static_cast<std::size_t>(std::max<std::ptrdiff_t>(after, 1) - 1);
  const Eigen::Vector3d& from = nodes_[k];
  const std::vector<Control> controls = ControlsBetween(odometry_, track_.time_s[k], time_s);
  Eigen::Vector3d motion = Integral(controls, errors_).motion;
  Eigen::Matrix3d covariance = covariances_[k];
  if (k + 1 < nodes_.size() && !controls.empty()) {
    const std::vector<Control>& all = track_.controls[k];
    const double part = std::clamp(Effort(controls) / Effort(all), 0.0, 1.0);
    const Eigen::Vector3d end = Integral(all, errors_).motion, &to = nodes_[k + 1];
    // The heading's error bends the way as it comes; what else is missing in the end shifts it.
    const double turn = to[2] - from[2] - end[2];
    const Eigen::Vector2d there = Rotated(to.head<2>() - from.head<2>(), -from[2]);
    const Eigen::Vector2d missing = there - Rotated(end.head<2>(), 0.5 * turn);
    motion.head<2>() = Rotated(motion.head<2>(), 0.5 * part * turn) + part * missing;
    motion[2] += part * turn;
    const EdgeSpread spread = SpreadOf(all, errors_);
    Eigen::Matrix3d to_map = Eigen::Matrix3d::Identity();
    to_map.topLeftCorner<2, 2>() << std::cos(from[2]), -std::sin(from[2]), std::sin(from[2]),
        std::cos(from[2]);
    covariance = (1.0 - part) * covariances_[k] + part * covariances_[k + 1] +
                 part * (1.0 - part) * to_map * CovarianceOf(spread, widths_) * to_map.transpose();
  }
  const Eigen::Vector2d at = from.head<2>() + Rotated(motion.head<2>(), from[2]);
  return {at.x(), at.y(), from[2] + motion[2], covariance};
}

}  // namespace cairn::landmark_map
