// What there is to draw of a `local_map`, as its arrays have it (schema/FORMAT.md).
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "datasets/evaluate/track.h"
#include "schema/blob.h"
#include "schema/geometry.h"

namespace cairn::datasets::report {

// NaN: no edge there, as where only some of its numbers are given.
struct LocalSide {
  double angle_low_rad = 0, angle_high_rad = 0, distance_low_m = 0, distance_high_m = 0;
  bool occupied = false;
  bool HasEdge() const {
    return !std::isnan(angle_low_rad + angle_high_rad + distance_low_m + distance_high_m);
  }
};
struct LocalFeature {
  LocalSide left, right;
};

struct LocalTrace {
  std::size_t robot = 0;
  double first_s = 0, last_s = 0;
  Pose frame;  // in the world frame: z is along it, u to its left
  std::int64_t first_z = 0;
  double cell_m = 0;
  std::vector<LocalFeature> features;

  double Z(std::size_t feature) const {
    return static_cast<double>(first_z + static_cast<std::int64_t>(feature)) * cell_m;
  }
  Point ToWorld(double z_m, double u_m) const;
};

struct LocalEdge {
  Point a, b;  // from the robot, in the grids' frame
};

// The local grids at a time, the robot in the central cell.
struct LocalSnapshot {
  std::size_t robot = 0;
  double time_s = 0, frame_rad = 0;
  std::int64_t cells = 0;  // along an edge
  double cell_m = 0;
  std::vector<float> occupancy, edge_rad;  // row 0 the lowest y; NaN: no edge
  std::vector<double> histogram;           // of wall orientations, sectors of pi/16
  std::vector<LocalEdge> edges;

  // A cell's centre from the robot's.
  Point Centre(std::int64_t column, std::int64_t row) const;
  std::size_t Index(std::int64_t column, std::int64_t row) const;
};

struct LocalConnection {
  std::size_t from = 0, to = 0;
  bool loop = false, used = false;
  double from_z_m = 0, from_u_m = 0, to_z_m = 0, to_u_m = 0;
};

// The live robot in a trace's frame.
struct LocalPosition {
  double time_s = 0, z_m = 0, u_m = 0;
  std::size_t trace = 0;
  bool corrected = false;
};

struct LocalResult {
  double cell_m = 0;
  std::vector<Track> paths;  // of each robot
  std::vector<LocalTrace> traces;
  std::vector<LocalConnection> connections;
  std::vector<LocalSnapshot> snapshots;
  std::vector<std::vector<LocalPosition>> positions;  // of each robot
};

// Throws InputError where it is no local_map, or its arrays do not fit each other.
LocalResult ReadLocalResult(const Blob& result);

}  // namespace cairn::datasets::report
