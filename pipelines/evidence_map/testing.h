// Scans made by hand, for tests.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "pipelines/common/range_scans.h"

namespace cairn::evidence_map {

// One beam along the robot's heading, one scan a pose.
inline RangeScans OneBeam(const std::vector<Pose>& poses, const std::vector<double>& range_m,
                          double opening_rad, double max_range_m) {
  RangeScans scans;
  scans.name = opening_rad > 0 ? "robot/0/sonar/" : "robot/0/laser/";
  scans.beams = {{0, 0, 0}};
  scans.opening_rad = opening_rad;
  scans.max_range_m = max_range_m;
  scans.pose = poses;
  scans.held_out.assign(poses.size(), 0);
  scans.checked = scans.held_out;
  for (std::size_t s = 0; s < poses.size(); ++s) {
    scans.time_s.push_back(static_cast<double>(s));
    scans.row.push_back(static_cast<std::int64_t>(s));
  }
  scans.range_m = Array::Of<double>({static_cast<std::int64_t>(poses.size()), 1}, range_m);
  return scans;
}

// Scans [first, first + count).
inline RangeScans ScansFrom(const RangeScans& scans, std::size_t first, std::size_t count) {
  const Blob all = ScansBlob(scans);
  Blob rows;
  for (const auto& [name, array] : all.fields()) {
    rows.Put(name, array.Rows(static_cast<std::int64_t>(first), static_cast<std::int64_t>(count)));
  }
  Blob log;
  log.Put(scans.name + "range_m", scans.range_m);
  return ScansOf(SensorBlob(scans), rows, log);
}

struct Untroubled : Progress {
  void Tick() override {}
};

}  // namespace cairn::evidence_map
