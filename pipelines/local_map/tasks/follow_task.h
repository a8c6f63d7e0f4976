// The last kind of task: the live localizer goes through a robot's scans and uses each trace once it has
// been recorded.
#pragma once

#include <vector>

#include "pipelines/local_map/path/localizer.h"
#include "pipelines/local_map/path/parts.h"
#include "pipelines/local_map/tasks/scan_reader.h"
#include "pipelines/pipeline.h"

namespace cairn::local_map {

// Connections of one trace with the next, and those by loops that are used, with the traces' places in the
// world frame.
std::vector<Connection> MakeConnections(const Parts& parts);

// `traces`: all; those of `robot` are used, in its order. FORMAT.md's positions/. `moved_m`: [scans] sd of
// what the robot may have moved beside its odometry since the scan before.
Blob Follow(ScanReader& scans, std::size_t robot, const std::vector<RecordedTrace>& traces,
            const std::vector<Connection>& connections, const std::vector<double>& moved_m,
            const GridOptions& grid, const LocalizerOptions& options, Progress& progress);

}  // namespace cairn::local_map
