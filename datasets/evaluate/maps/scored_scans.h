// The range readings of a log at the poses that a grid map was made with.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "schema/blob.h"
#include "schema/geometry.h"

namespace cairn::datasets {

struct ScoredSensor {
  std::string name;  // "robot/0/sonar/"
  std::size_t robot = 0;
  double opening_rad = 0, max_range_m = 0;
  std::vector<Pose> beams;             // on the robot
  std::vector<double> time_s;          // of each scan
  std::vector<double> turret_rad;      // by which the beams were turned; empty: not
  std::vector<Pose> poses;             // of the robot at each scan
  std::vector<std::uint8_t> held_out;  // 1: the map does not know of this scan
  std::vector<double> range_m;         // [scans][beams]; NaN: no echo

  Pose BeamPose(std::size_t scan, std::size_t beam) const;
  // These scans alone, at these poses.
  ScoredSensor At(const std::vector<std::size_t>& scans, const std::vector<Pose>& poses) const;
};

// The sensors that `map` (a grid_map) says it was made of: its poses, the log's readings of the same times.
// Throws InputError: a sensor or a scan that the log does not have, columns that do not fit.
std::vector<ScoredSensor> ReadScoredScans(const Blob& map, const Blob& log);

}  // namespace cairn::datasets
