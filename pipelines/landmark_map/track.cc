#include "pipelines/landmark_map/track.h"

#include <algorithm>
#include <cmath>

namespace cairn::landmark_map {
namespace {

[[noreturn]] void Refuse(const std::string& robot, std::size_t row, const std::string& why) {
  throw InputError("robot '" + robot + "', control " + std::to_string(row) + ": " + why);
}

}  // namespace

Odometry Integrate(const Blob& robot, const std::string& name) {
  const auto time = robot.Get<double>("odometry/time_s");
  const auto turn = robot.Get<double>("odometry/turn_rad");
  const auto forward = robot.Get<double>("odometry/forward_m");
  if (time.empty()) throw InputError("robot '" + name + "' has no controls: there is nothing to map");
  if (turn.size() != time.size() || forward.size() != time.size()) {
    throw InputError("robot '" + name + "': odometry arrays differ in length");
  }
  Odometry odometry;
  odometry.time_s = {time[0]};
  odometry.x_m = odometry.y_m = odometry.heading_rad = odometry.path_m = odometry.turn_rad = {0.0};
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (!std::isfinite(time[i]) || !std::isfinite(turn[i]) || !std::isfinite(forward[i]))
      Refuse(name, i, "not a number");
    if (time[i] < odometry.time_s.back()) Refuse(name, i, "time runs backwards");
    const double heading = odometry.heading_rad.back() + turn[i];
    odometry.time_s.push_back(time[i]);
    odometry.heading_rad.push_back(heading);
    odometry.x_m.push_back(odometry.x_m.back() + forward[i] * std::cos(heading));
    odometry.y_m.push_back(odometry.y_m.back() + forward[i] * std::sin(heading));
    odometry.path_m.push_back(odometry.path_m.back() + std::abs(forward[i]));
    odometry.turn_rad.push_back(odometry.turn_rad.back() + std::abs(turn[i]));
  }
  return odometry;
}

OdometricPose PoseAt(const Odometry& odometry, double time_s) {
  const auto& time = odometry.time_s;
  const auto after = static_cast<std::size_t>(std::ranges::lower_bound(time, time_s) - time.begin());
  if (after == 0) return {time_s, 0.0, 0.0, 0.0, 0.0, 0.0};
  const std::size_t i = std::min(after, time.size() - 1);
  const double span = time[i] - time[i - 1];
  const double part = span > 0 ? std::min(1.0, (time_s - time[i - 1]) / span) : 1.0;
  const auto between = [&](const std::vector<double>& v) { return v[i - 1] + part * (v[i] - v[i - 1]); };
  return {time_s,
          between(odometry.x_m),
          between(odometry.y_m),
          odometry.heading_rad[i],
          between(odometry.path_m),
          odometry.turn_rad[i]};
}

}  // namespace cairn::landmark_map
