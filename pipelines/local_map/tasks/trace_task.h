// The second kind of task: grids along a path whose headings are known record traces over straight runs, and
// keep what was around the robot at nodes.
#pragma once

#include <cstdint>
#include <vector>

#include "pipelines/local_map/grids/grid_options.h"
#include "pipelines/local_map/tasks/scan_reader.h"
#include "pipelines/local_map/tasks/snapshot.h"
#include "pipelines/local_map/traces/arrays.h"
#include "pipelines/pipeline.h"

namespace cairn::local_map {

struct RecordOptions {
  double least_m = 1.0;     // travelled; a trace over less is none
  double begin_rad = 0.25;  // a trace begins where the heading is so near to an axis
};

// Immediate traces of one scan in the four directions: 4 (2 half + 1) kFeatureNumbers numbers, and where the
// robot is in each, as z_m and u_m.
struct Surroundings {
  std::vector<float> features;
  std::vector<double> robot;
};

// `nodes`: scans, counted as the reader does, in order; `own`: the first that is this task's own. `hints`:
// times at which a trace ends.
struct Recorded {
  std::vector<RecordedTrace> traces;  // scans counted as the reader does, robot 0
  Surroundings nodes;
  Snapshots snapshot;  // of the last scan
};
Recorded Record(ScanReader& scans, std::size_t own, std::span<const std::int64_t> nodes,
                std::span<const double> hints, const GridOptions& grid, const RecordOptions& options,
                Progress& progress);

}  // namespace cairn::local_map
