// Readings of a log at the poses of a table of it, for tests: from the log's arrays alone.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "datasets/common/walls.h"
#include "schema/blob.h"
#include "schema/geometry.h"

namespace cairn::datasets {

struct Reading {
  Point from;
  double heading_rad = 0, range_m = 0;
  int cause = 0;
  double time_s = 0;
  Point End() const {
    return {from.x_m + range_m * std::cos(heading_rad), from.y_m + range_m * std::sin(heading_rad)};
  }
};

// Of `sensor` of robot 0, at `poses` ("truth/robot/0/poses/", say), of which the first is before any scan.
inline std::vector<Reading> ReadingsOf(const Blob& log, const std::string& sensor, const std::string& poses) {
  const std::string prefix = "robot/0/" + sensor + "/";
  const auto range = log.Get<double>(prefix + "range_m"), time = log.Get<double>(prefix + "time_s");
  const auto mount_x = log.Get<double>(prefix + "beam_x_m"), mount_y = log.Get<double>(prefix + "beam_y_m"),
             mount = log.Get<double>(prefix + "beam_heading_rad");
  const auto x = log.Get<double>(poses + "x_m"), y = log.Get<double>(poses + "y_m"),
             heading = log.Get<double>(poses + "heading_rad");
  const auto cause = log.Get<std::uint8_t>("truth/" + prefix + "cause");
  std::vector<double> turret(time.size(), 0);
  if (log.Has(prefix + "turret_rad")) {
    const auto turned = log.Get<double>(prefix + "turret_rad");
    turret.assign(turned.begin(), turned.end());
  }
  std::vector<Reading> readings;
  for (std::size_t i = 0; i < range.size(); ++i) {
    const std::size_t scan = i / mount.size(), beam = i % mount.size();
    const double ring = heading[scan + 1] + turret[scan], c = std::cos(ring), s = std::sin(ring);
    readings.push_back({{x[scan + 1] + c * mount_x[beam] - s * mount_y[beam],
                         y[scan + 1] + s * mount_x[beam] + c * mount_y[beam]},
                        ring + mount[beam],
                        range[i],
                        cause[i],
                        time[scan]});
  }
  return readings;
}

inline std::vector<Wall> SegmentsOf(const Blob& log, const std::string& prefix) {
  const auto x = log.Get<double>(prefix + "x_m"), y = log.Get<double>(prefix + "y_m");
  std::vector<Wall> walls;
  for (std::size_t i = 0; i + 1 < x.size(); i += 2) walls.push_back({{x[i], y[i]}, {x[i + 1], y[i + 1]}});
  return walls;
}

}  // namespace cairn::datasets
