#include "datasets/evaluate/maps/scored_scans.h"

#include <cmath>

namespace cairn::datasets {
namespace {

std::vector<Pose> PosesOf(const Blob& blob, const std::string& prefix) {
  const auto x = blob.Get<double>(prefix + "x_m"), y = blob.Get<double>(prefix + "y_m"),
             heading = blob.Get<double>(prefix + "heading_rad");
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < x.size(); ++i) poses.push_back({x[i], y[i], heading[i]});
  return poses;
}

// The map's scans are the log's, in order, some left out.
void TakeRanges(const Blob& log, ScoredSensor* sensor) {
  const auto time = log.Get<double>(sensor->name + "time_s");
  const std::size_t beams = sensor->beams.size();
  const auto range = log.Get<double>(sensor->name + "range_m");
  const std::string turret = sensor->name + "turret_rad";
  std::size_t next = 0;
  for (const double time_s : sensor->time_s) {
    while (next < time.size() && time[next] != time_s) ++next;
    if (next == time.size())
      throw InputError("the log has no scan of '" + sensor->name + "' at " + std::to_string(time_s) +
                       " s: was the map made from this log?");
    const auto row = range.subspan(next * beams, beams);
    sensor->range_m.insert(sensor->range_m.end(), row.begin(), row.end());
    if (log.Has(turret)) sensor->turret_rad.push_back(log.Get<double>(turret)[next]);
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
  sensor.beams = PosesOf(log, name + "beam_");
  const auto time = map.Get<double>(name + "time_s");
  sensor.time_s.assign(time.begin(), time.end());
  sensor.poses = PosesOf(map, name);
  const auto held_out = map.Get<std::uint8_t>(name + "held_out");
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
