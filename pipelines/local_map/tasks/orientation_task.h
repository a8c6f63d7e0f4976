// The first rounds: local grids over segments of runs tell how edges lie.
#pragma once

#include <cstddef>
#include <optional>

#include "pipelines/local_map/grids/grid_options.h"
#include "pipelines/local_map/tasks/scan_reader.h"
#include "pipelines/pipeline.h"

namespace cairn::local_map {

// `edges_m` [scans - own, kBins]: directions of the current edges modulo pi / 2, in the frame of the rows'
// poses, of each scan from `own` on. `approaches/` to walls (path/scale_watch.h): with `ahead` to what lies
// ahead of and behind the robot, else along the axes, as walls then do; scans are counted from the first own.
// `motion/`: what the scans contradict of the rows' motion (path/motion_watch.h), its scans counted from the
// task's first; only where `ahead` says how many scans at the beginning are of an earlier run, which serve
// the motion alone.
Blob WatchWalls(ScanReader& scans, std::size_t own, const std::optional<std::size_t>& ahead,
                GridOptions options, Progress& progress);

}  // namespace cairn::local_map
