#include "pipelines/common/odometry.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace cairn {
namespace {

[[noreturn]] void Refuse(const std::string& robot, std::size_t row, const std::string& why) {
  throw InputError("robot '" + robot + "', control " + std::to_string(row) + ": " + why);
}

// The start lies as long before the first control's end as controls usually take.
double UsualInterval(std::span<const double> time) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < time.size(); ++i) {
    if (time[i] > time[i - 1]) intervals.push_back(time[i] - time[i - 1]);
  }
  if (intervals.empty()) return 1.0;
  std::ranges::nth_element(intervals, intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2));
  return intervals[intervals.size() / 2];
}

bool IsAside(const Odometry& odometry, std::size_t i) {
  const std::vector<double>&time = odometry.time_s, &heading = odometry.heading_rad, &path = odometry.path_m;
  return i + 1 < time.size() && time[i] == time[i + 1] && path[i] == path[i + 1] &&
         GoesAside(heading[i - 1], heading[i], heading[i + 1]);
}

void TellAsides(Odometry* odometry) {
  std::vector<double>&heading = odometry->heading_rad, &turn = odometry->turn_rad;
  odometry->aside_rad.assign(heading.size(), 0.0);
  double back = 0.0;  // turned back so far, and as much before that
  for (std::size_t i = 1; i < heading.size(); ++i) {
    turn[i] -= back;
    if (!IsAside(*odometry, i)) continue;
    const double left = heading[i + 1] - heading[i - 1], middle = heading[i - 1] + 0.5 * left;
    odometry->aside_rad[i] = heading[i] - middle;
    heading[i] = middle;
    turn[i] = turn[i - 1] + 0.5 * std::abs(left);
    back = turn[i + 1] - (turn[i - 1] + std::abs(left));
  }
}

// After the turn and `part` of the distance of the control that ends in state `i`.
OdometricPose Within(const Odometry& odometry, std::size_t i, double part) {
  const auto between = [&](const std::vector<double>& v) { return v[i - 1] + part * (v[i] - v[i - 1]); };
  return {between(odometry.time_s), between(odometry.x_m),    between(odometry.y_m),
          odometry.heading_rad[i],  between(odometry.path_m), odometry.turn_rad[i]};
}

}  // namespace

Odometry Integrate(const kinds::Log::Odometry& controls, const std::string& name) {
  const std::span<const double> time = controls.time_s, turn = controls.turn_rad,
                                forward = controls.forward_m;
  if (time.empty()) throw InputError("robot '" + name + "' has no controls: there is nothing to map");
  Odometry odometry;
  // A first row without motion, as of a log of poses, says when the robot stood at the start.
  const bool stands = turn[0] == 0 && forward[0] == 0;
  odometry.time_s = {stands ? time[0] : time[0] - UsualInterval(time)};
  odometry.x_m = odometry.y_m = odometry.heading_rad = odometry.path_m = odometry.turn_rad = {0.0};
  for (std::size_t i = 0; i < time.size(); ++i) {
    constexpr double kFarthest_m = 1e5, kLargestTurn_rad = 1e3;  // no robot does so in one control
    if (std::abs(forward[i]) > kFarthest_m || std::abs(turn[i]) > kLargestTurn_rad) {
      Refuse(name, i, "a distance or turn too large to be one");
    }
    const double heading = odometry.heading_rad.back() + turn[i];
    odometry.time_s.push_back(time[i]);
    odometry.heading_rad.push_back(heading);
    odometry.x_m.push_back(odometry.x_m.back() + forward[i] * std::cos(heading));
    odometry.y_m.push_back(odometry.y_m.back() + forward[i] * std::sin(heading));
    odometry.path_m.push_back(odometry.path_m.back() + std::abs(forward[i]));
    odometry.turn_rad.push_back(odometry.turn_rad.back() + std::abs(turn[i]));
  }
  TellAsides(&odometry);
  return odometry;
}

bool GoesAside(double from_rad, double way_rad, double to_rad) {
  constexpr double kSwings_rad = 0.2;
  return std::abs(way_rad - from_rad) + std::abs(to_rad - way_rad) >
         std::abs(to_rad - from_rad) + kSwings_rad;
}

Odometry Until(Odometry odometry, double until_s) {
  const auto& time = odometry.time_s;
  const auto under_way = std::ranges::lower_bound(time, until_s) - time.begin();
  const std::size_t kept = std::min(time.size(), static_cast<std::size_t>(under_way) + 1);
  for (std::vector<double>* column : {&odometry.time_s, &odometry.x_m, &odometry.y_m, &odometry.heading_rad,
                                      &odometry.path_m, &odometry.turn_rad, &odometry.aside_rad}) {
    column->resize(kept);
  }
  return odometry;
}

OdometricPose PoseOf(const Odometry& odometry, std::size_t i) {
  return {odometry.time_s[i],      odometry.x_m[i],    odometry.y_m[i],
          odometry.heading_rad[i], odometry.path_m[i], odometry.turn_rad[i]};
}

OdometricPose PoseAt(const Odometry& odometry, double time_s) {
  const auto& time = odometry.time_s;
  const auto next = static_cast<std::size_t>(std::ranges::upper_bound(time, time_s) - time.begin());
  if (next == 0 || next == time.size()) {
    OdometricPose end = PoseOf(odometry, next == 0 ? 0 : next - 1);
    end.time_s = time_s;
    return end;
  }
  if (time[next - 1] == time_s) return PoseOf(odometry, next - 1);  // the next control has not turned yet
  return Within(odometry, next, (time_s - time[next - 1]) / (time[next] - time[next - 1]));
}

OdometricPose PoseAtPath(const Odometry& odometry, double path_m) {
  const auto& path = odometry.path_m;
  const auto next = static_cast<std::size_t>(std::ranges::lower_bound(path, path_m) - path.begin());
  if (next == 0 || next == path.size()) return PoseOf(odometry, next == 0 ? 0 : next - 1);
  return Within(odometry, next, (path_m - path[next - 1]) / (path[next] - path[next - 1]));
}

}  // namespace cairn
