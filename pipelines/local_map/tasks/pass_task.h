// Between the pose graph and the live localizer: do the scans of places that the robot passed more than once
// meet where the path has them?
#pragma once

#include <vector>

#include "pipelines/local_map/path/runs.h"
#include "pipelines/local_map/tasks/scan_reader.h"
#include "pipelines/pipeline.h"

namespace cairn::local_map {

// Rows of Passing (path/pass_watch.h), by the laser that has the most beams. `rows`: the scans on the
// optimized path.
Blob WatchPasses(ScanReader& scans, const std::vector<Scan>& rows, Progress& progress);

}  // namespace cairn::local_map
