#include "pipelines/local_map/path/runs.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "schema/error.h"

namespace cairn::local_map {
namespace {

// Times of controls are off by some; what is less than this is no jump, however short the time.
constexpr double kLeastJump_m = 0.7, kLeastJump_rad = 1.6;

constexpr double kUnsure_rad = 0.08;

std::string Prefix(std::size_t robot) { return "robot/" + std::to_string(robot) + "/"; }

// Of a robot whose log has poses only: the turn at once, then the way.
Odometry OfPoses(const kinds::PoseTable& poses, const std::string& name) {
  const std::span<const double> time = poses.time_s, x = poses.x_m, y = poses.y_m,
                                heading = poses.heading_rad;
  if (time.empty()) throw InputError("robot '" + name + "': '" + poses.time_s.name() + "' is empty");
  Odometry path;
  double path_m = 0, turned = 0, unwrapped = heading[0];
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (i > 0) {
      const double turn = WrapAngle(heading[i] - heading[i - 1]);
      unwrapped += turn;
      turned += std::abs(turn);
      path_m += std::hypot(x[i] - x[i - 1], y[i] - y[i - 1]);
    }
    path.time_s.push_back(time[i]);
    path.x_m.push_back(x[i]);
    path.y_m.push_back(y[i]);
    path.heading_rad.push_back(unwrapped);
    path.path_m.push_back(path_m);
    path.turn_rad.push_back(turned);
  }
  return path;
}

Blob PosesOf(const std::vector<std::string>& names, const std::vector<Odometry>& robots) {
  kinds::Poses all{names, {}};
  for (const Odometry& robot : robots)
    all.robot.push_back({{{robot.time_s, robot.x_m, robot.y_m, robot.heading_rad}, {}}});
  return BlobOf(all);
}

struct Reading {
  double time_s;
  std::size_t sensor;       // of the robot's
  std::int64_t row_of_log;  // of the log's
};

std::vector<Reading> ReadingsOf(const PosedScans& scans, const RobotRuns& runs) {
  std::vector<Reading> readings;
  for (std::size_t k = 0; k < runs.sensors.size(); ++k) {
    const RangeScans& sensor = scans.sensors[runs.sensors[k]];
    for (std::size_t s = 0; s < sensor.scans(); ++s) readings.push_back({sensor.time_s[s], k, sensor.row[s]});
  }
  std::ranges::stable_sort(readings, {}, &Reading::time_s);
  return readings;
}

// What the control that is under way has turned by then and what it turns yet, if evenly. (0, 0): none is.
std::pair<double, double> TurnUnderWay(const Odometry& odometry, double time_s) {
  const auto& time = odometry.time_s;
  const auto next = static_cast<std::size_t>(std::ranges::upper_bound(time, time_s) - time.begin());
  if (next == 0 || next == time.size() || time[next - 1] == time_s) return {};
  const double turn = odometry.heading_rad[next] - odometry.heading_rad[next - 1],
               part = (time_s - time[next - 1]) / (time[next] - time[next - 1]);
  return {part * turn, (1 - part) * turn};
}

void AddScan(const Odometry& odometry, double time_s, RobotRuns* runs) {
  const OdometricPose at = PoseAt(odometry, time_s);
  const auto [done_rad, left_rad] = TurnUnderWay(odometry, time_s);
  const bool unsure = std::min(std::abs(done_rad), std::abs(left_rad)) > kUnsure_rad;
  runs->scans.push_back({.time_s = time_s,
                         .pose = {at.x_m, at.y_m, at.heading_rad - left_rad},
                         .path_m = at.path_m,
                         .unsure = unsure});
  runs->row_of_log.insert(runs->row_of_log.end(), runs->sensors.size(), -1);
}

void AddScans(const std::vector<Reading>& readings, const Odometry& odometry, RobotRuns* runs) {
  const std::size_t sensors = runs->sensors.size();
  for (const Reading& reading : readings) {
    const bool has_scan = !runs->scans.empty();
    const bool taken = has_scan && runs->row_of_log[runs->row_of_log.size() - sensors + reading.sensor] >= 0;
    if (!has_scan || taken || reading.time_s - runs->scans.back().time_s > kTogether_s)
      AddScan(odometry, reading.time_s, runs);
    runs->row_of_log[runs->row_of_log.size() - sensors + reading.sensor] = reading.row_of_log;
  }
}

void CutScans(const std::vector<double>& jumps, double gap_s, RobotRuns* runs) {
  std::int32_t run = 0;
  std::size_t next = 0;
  for (std::size_t s = 1; s < runs->scans.size(); ++s) {
    const double before_s = runs->scans[s - 1].time_s, time_s = runs->scans[s].time_s;
    while (next < jumps.size() && jumps[next] <= before_s) ++next;  // no scan was before it
    const bool jumped = next < jumps.size() && jumps[next] <= time_s;
    if (jumped || time_s - before_s > gap_s) {
      runs->cuts.push_back({before_s, jumped ? "jump" : "gap"});
      ++run;
    }
    runs->scans[s].run = run;
    runs->scans[s].jumped = jumped;
  }
}

// More than a robot can do in that time.
bool IsJump(const OdometricPose& from, const OdometricPose& to, const RunOptions& options) {
  const double duration_s = to.time_s - from.time_s;
  return std::hypot(to.x_m - from.x_m, to.y_m - from.y_m) >
             std::max(kLeastJump_m, options.jump_mps * duration_s) ||
         std::abs(to.heading_rad - from.heading_rad) >
             std::max(kLeastJump_rad, options.jump_radps * duration_s);
}

}  // namespace

Odometry WithoutJumps(Odometry odometry, const RunOptions& options, std::vector<double>* jumps) {
  const Odometry raw = odometry;
  double turn = 0, path = 0, turned = 0;  // that were taken out so far
  const std::size_t count = raw.time_s.size();
  for (std::size_t i = 1, end = 1; i < count; i = end) {
    // Controls of one moment are one motion: to where it went, and to where the robot then faces.
    for (end = i + 1; end < count && raw.time_s[end] == raw.time_s[i]; ++end) {
    }
    const bool jumped = IsJump(PoseOf(raw, i - 1), PoseOf(raw, end - 1), options);
    if (jumped) {
      jumps->push_back(raw.time_s[i]);
      turn += raw.heading_rad[end - 1] - raw.heading_rad[i - 1];
      path += raw.path_m[end - 1] - raw.path_m[i - 1];
      turned += raw.turn_rad[end - 1] - raw.turn_rad[i - 1];
    }
    const double c = std::cos(turn), s = std::sin(turn);
    for (std::size_t k = i; k < end; ++k) {
      // After a jump the path goes on from where it was, on the heading that it had.
      const double dx = jumped ? 0 : raw.x_m[k] - raw.x_m[k - 1],
                   dy = jumped ? 0 : raw.y_m[k] - raw.y_m[k - 1];
      odometry.x_m[k] = odometry.x_m[k - 1] + c * dx + s * dy;
      odometry.y_m[k] = odometry.y_m[k - 1] - s * dx + c * dy;
      odometry.heading_rad[k] = jumped ? odometry.heading_rad[i - 1] : raw.heading_rad[k] - turn;
      odometry.path_m[k] = jumped ? odometry.path_m[i - 1] : raw.path_m[k] - path;
      odometry.turn_rad[k] = jumped ? odometry.turn_rad[i - 1] : raw.turn_rad[k] - turned;
    }
  }
  return odometry;
}

DeadReckoning ReckonAll(const Blob& blob, const RunOptions& options) {
  const auto log = Read<kinds::Log>(blob);
  const std::vector<std::string>& names = log.robots;
  DeadReckoning reckoning;
  for (std::size_t r = 0; r < names.size(); ++r) {
    const kinds::Log::Robot& robot = log.robot[r];
    if (!robot.HasControls() && !robot.poses.time_s)
      throw InputError("robot '" + names[r] + "' has neither odometry nor poses: where it was is not known");
    const Odometry raw =
        robot.HasControls() ? Integrate(robot.odometry, names[r]) : OfPoses(robot.poses, names[r]);
    reckoning.robots.push_back(WithoutJumps(raw, options, &reckoning.jumps.emplace_back()));
  }
  reckoning.poses = PosesOf(names, reckoning.robots);
  return reckoning;
}

std::vector<RobotRuns> CutRuns(const PosedScans& scans, const DeadReckoning& reckoning,
                               const RunOptions& options) {
  std::vector<RobotRuns> robots(reckoning.robots.size());
  for (std::size_t r = 0; r < robots.size(); ++r) {
    for (std::size_t k = 0; k < scans.sensors.size(); ++k)
      if (scans.sensors[k].name.starts_with(Prefix(r))) robots[r].sensors.push_back(k);
    AddScans(ReadingsOf(scans, robots[r]), reckoning.robots[r], &robots[r]);
    CutScans(reckoning.jumps[r], options.gap_s, &robots[r]);
  }
  return robots;
}

Blob RowsOf(const RobotRuns& runs) {
  Blob blob = BlobOf(runs.scans);
  const auto count = static_cast<std::int64_t>(runs.scans.size());
  blob.Put("row_of_log",
           Array::Of<std::int64_t>({count, static_cast<std::int64_t>(runs.sensors.size())}, runs.row_of_log));
  return blob;
}

}  // namespace cairn::local_map
