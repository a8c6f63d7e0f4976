#include "datasets/import/pose_controls.h"

#include <cmath>
#include <numbers>

#include "datasets/common/control.h"

namespace cairn::datasets {
namespace {

// A turn, a way and a turn; the way in the direction of the heading or against it.
struct MotionIncrement {
  double before_rad = 0, forward_m = 0, after_rad = 0;
};

MotionIncrement IncrementTo(const Pose& from, const Pose& to) {
  constexpr double kPi = std::numbers::pi;
  const double turn = WrapAngle(to.heading_rad - from.heading_rad);
  const double dx = to.x_m - from.x_m, dy = to.y_m - from.y_m;
  const double middle = from.heading_rad + turn / 2;
  const double along = dx * std::cos(middle) + dy * std::sin(middle);
  const double aside = dy * std::cos(middle) - dx * std::sin(middle);
  if (std::abs(aside) <= kMostAsideM) {
    // In place it only turns: what is less than that along the way waits too.
    if (turn != 0 && std::abs(along) <= kMostAsideM) return {turn, 0, 0};
    return {turn / 2, along, turn / 2};
  }
  double before = WrapAngle(std::atan2(dy, dx) - from.heading_rad), forward = std::hypot(dx, dy);
  if (std::abs(before) > kPi / 2) {
    before = WrapAngle(before + kPi);
    forward = -forward;
  }
  return {before, forward, WrapAngle(turn - before)};
}

// `at(i)`: the pose of that number.
Odometry ControlsAlong(std::size_t poses, const auto& at, const std::filesystem::path& folder) {
  Odometry odometry(folder);
  if (poses == 0) return odometry;
  TimedPose now = at(0);
  odometry.Add(now.time_s, 0, 0);
  Pose reckoned = now.pose;
  for (std::size_t i = 1; i < poses; ++i) {
    const double halt_s = now.time_s;  // a move began no sooner than the pose before
    now = at(i);
    const MotionIncrement increment = IncrementTo(reckoned, now.pose);
    const bool still = increment.before_rad == 0 && increment.forward_m == 0 && increment.after_rad == 0;
    if (still && i + 1 < poses) continue;
    if (odometry.time_s.back() < halt_s) odometry.Add(halt_s, 0, 0);
    odometry.Add(now.time_s, increment.before_rad, increment.forward_m);
    if (increment.after_rad != 0) odometry.Add(now.time_s, increment.after_rad, 0);
    reckoned = Apply(Apply(reckoned, {increment.before_rad, increment.forward_m}), {increment.after_rad, 0});
    reckoned.heading_rad = now.pose.heading_rad;
  }
  return odometry;
}

}  // namespace

Odometry ControlsOf(const std::vector<TimedPose>& poses) {
  return ControlsAlong(poses.size(), [&](std::size_t i) { return poses[i]; }, {});
}

Odometry ControlsOf(const Poses& poses) {
  return ControlsAlong(
      poses.time_s.size(),
      [&](std::size_t i) {
        return TimedPose{poses.time_s[i], {poses.x_m[i], poses.y_m[i], WrapAngle(poses.heading_rad[i])}};
      },
      poses.time_s.folder());
}

}  // namespace cairn::datasets
