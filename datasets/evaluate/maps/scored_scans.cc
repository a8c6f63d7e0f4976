#include "datasets/evaluate/maps/scored_scans.h"

#include <cmath>
#include <limits>

#include "schema/kinds/grid_map.h"
#include "schema/kinds/log.h"

namespace cairn::datasets {
namespace {

// The map's scans are the log's, in order, some left out.
void TakeRanges(const kinds::Log::RangeSensor& log, ScoredSensor* sensor) {
  const std::size_t beams = sensor->beams.size();
  const std::span<const double> time = log.time_s, range = log.range_m;
  std::size_t next = 0;
  for (const double time_s : sensor->time_s) {
    while (next < time.size() && time[next] != time_s) ++next;
    if (next == time.size())
      throw InputError("the log has no scan of '" + sensor->name + "' at " + std::to_string(time_s) +
                       " s: was the map made from this log?");
    const auto row = range.subspan(next * beams, beams);
    for (const double range_m : row)
      sensor->range_m.push_back(
          kinds::IsEcho(range_m, sensor->max_range_m) ? range_m : std::numeric_limits<double>::quiet_NaN());
    if (log.turret_rad) sensor->turret_rad.push_back(log.turret_rad[next]);
    ++next;
  }
}

ScoredSensor SensorOf(const kinds::GridMap::Sensor& map, const Blob& log, std::size_t robot) {
  ScoredSensor sensor;
  sensor.name = "robot/" + std::to_string(robot) + "/" + map.sensor + "/";
  sensor.robot = robot;
  const auto in_log = FieldsIn<kinds::Log::RangeSensor>(sensor.name, log);
  if (!in_log.range_m) throw InputError("the log has no '" + sensor.name + "', of which the map was made");
  sensor.opening_rad = in_log.opening_rad.Scalar();
  sensor.max_range_m = in_log.max_range_m.Scalar();
  for (std::size_t b = 0; b < in_log.beam_x_m.size(); ++b)
    sensor.beams.push_back({in_log.beam_x_m[b], in_log.beam_y_m[b], in_log.beam_heading_rad[b]});
  sensor.time_s = map.time_s.vector();
  sensor.poses = map.poses();
  sensor.held_out = map.held_out.vector();
  TakeRanges(in_log, &sensor);
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

ScoredSensor ScoredSensor::At(const std::vector<std::size_t>& scans, const std::vector<Pose>& at) const {
  ScoredSensor some{.name = name,
                    .robot = robot,
                    .opening_rad = opening_rad,
                    .max_range_m = max_range_m,
                    .beams = beams,
                    .time_s = {},
                    .turret_rad = {},
                    .poses = at,
                    .held_out = {},
                    .range_m = {}};
  for (const std::size_t scan : scans) {
    some.time_s.push_back(time_s[scan]);
    if (!turret_rad.empty()) some.turret_rad.push_back(turret_rad[scan]);
    some.held_out.push_back(held_out[scan]);
    for (std::size_t beam = 0; beam < beams.size(); ++beam)
      some.range_m.push_back(range_m[scan * beams.size() + beam]);
  }
  return some;
}

std::vector<ScoredSensor> ReadScoredScans(const Blob& map, const Blob& log) {
  std::vector<ScoredSensor> sensors;
  const auto of = Read<kinds::GridMap>(map);
  for (std::size_t r = 0; r < of.robot.size(); ++r) {
    for (const kinds::GridMap::Sensor& sensor : of.robot[r].sensors)
      if (sensor.held_out) sensors.push_back(SensorOf(sensor, log, r));
  }
  if (sensors.empty())
    throw InputError("the map does not say at which poses which scans were taken (robot/…/held_out)");
  return sensors;
}

}  // namespace cairn::datasets
