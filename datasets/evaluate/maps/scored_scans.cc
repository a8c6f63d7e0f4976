#include "datasets/evaluate/maps/scored_scans.h"

#include <cmath>

namespace cairn::datasets {
namespace {

std::span<const double> ScanColumn(const Blob& blob, const std::string& name, std::size_t length) {
  const auto column = blob.Get<double>(name);
  if (column.size() != length)
    throw InputError("'" + name + "' has " + std::to_string(column.size()) + " numbers, where " +
                     std::to_string(length) + " are needed");
  return column;
}

std::vector<Pose> PosesOf(const Blob& blob, const std::string& prefix, const std::string& kind,
                          std::size_t count) {
  const auto x = ScanColumn(blob, prefix + kind + "x_m", count),
             y = ScanColumn(blob, prefix + kind + "y_m", count),
             heading = ScanColumn(blob, prefix + kind + "heading_rad", count);
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < count; ++i) {
    if (!std::isfinite(x[i] + y[i] + heading[i]))
      throw InputError("'" + prefix + "', row " + std::to_string(i) + ": a pose is not of numbers");
    poses.push_back({x[i], y[i], heading[i]});
  }
  return poses;
}

// The map's scans are the log's, in order, some left out.
void TakeRanges(const Blob& log, ScoredSensor* sensor) {
  const auto time = log.Get<double>(sensor->name + "time_s");
  const std::size_t beams = sensor->beams.size();
  const auto range = ScanColumn(log, sensor->name + "range_m", time.size() * beams);
  const std::string turret = sensor->name + "turret_rad";
  std::size_t next = 0;
  for (const double time_s : sensor->time_s) {
    while (next < time.size() && time[next] != time_s) ++next;
    if (next == time.size())
      throw InputError("the log has no scan of '" + sensor->name + "' at " + std::to_string(time_s) +
                       " s: was the map made from this log?");
    const auto row = range.subspan(next * beams, beams);
    sensor->range_m.insert(sensor->range_m.end(), row.begin(), row.end());
    if (log.Has(turret)) sensor->turret_rad.push_back(ScanColumn(log, turret, time.size())[next]);
    ++next;
  }
}

ScoredSensor ReadSensor(const Blob& map, const Blob& log, const std::string& name) {
  if (!log.Has(name + "range_m"))
    throw InputError("the log has no '" + name + "', of which the map was made");
  ScoredSensor sensor;
  sensor.name = name;
  sensor.opening_rad = log.Scalar<double>(name + "opening_rad");
  sensor.max_range_m = log.Scalar<double>(name + "max_range_m");
  sensor.beams = PosesOf(log, name, "beam_", log.Get<double>(name + "beam_x_m").size());
  const auto time = map.Get<double>(name + "time_s");
  sensor.time_s.assign(time.begin(), time.end());
  sensor.poses = PosesOf(map, name, "", time.size());
  const auto held_out = map.Get<std::uint8_t>(name + "held_out");
  if (held_out.size() != time.size())
    throw InputError("'" + name + "held_out' and its time_s differ in length");
  sensor.held_out.assign(held_out.begin(), held_out.end());
  TakeRanges(log, &sensor);
  return sensor;
}

}  // namespace

Pose ScoredSensor::BeamPose(std::size_t scan, std::size_t beam) const {
  const Pose &robot = poses[scan], &mount = beams[beam];
  const double heading = robot.heading_rad + (turret_rad.empty() ? 0 : turret_rad[scan]);
  const double c = std::cos(heading), s = std::sin(heading);
  return {robot.x_m + c * mount.x_m - s * mount.y_m, robot.y_m + s * mount.x_m + c * mount.y_m,
          heading + mount.heading_rad};
}

std::vector<ScoredSensor> ReadScoredScans(const Blob& map, const Blob& log) {
  std::vector<ScoredSensor> sensors;
  for (const auto& [name, array] : map.fields()) {
    constexpr std::string_view kLast = "held_out";
    if (name.starts_with("robot/") && name.ends_with(kLast))
      sensors.push_back(ReadSensor(map, log, name.substr(0, name.size() - kLast.size())));
  }
  if (sensors.empty())
    throw InputError("the map does not say at which poses which scans were taken (robot/…/held_out)");
  return sensors;
}

}  // namespace cairn::datasets
