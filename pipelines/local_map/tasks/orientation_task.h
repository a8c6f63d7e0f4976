// The first rounds: local grids over segments of runs tell how edges lie.
#pragma once

#include "pipelines/local_map/grids/grid_options.h"
#include "pipelines/local_map/tasks/scan_reader.h"
#include "pipelines/pipeline.h"

namespace cairn::local_map {

// `edges_m` [scans - own, kBins]: directions of the current edges modulo pi / 2, in the frame of the rows'
// poses, of each scan from `own` on. `along2_m2`, `along_distance_m2` of approaches to walls
// (path/scale_watch.h), which mean something where walls lie along the axes.
Blob WatchWalls(ScanReader& scans, std::size_t own, GridOptions options, Progress& progress);

}  // namespace cairn::local_map
