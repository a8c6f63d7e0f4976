// A robot's path with the headings that walls give.
#pragma once

#include <vector>

#include "pipelines/local_map/path/orientation_track.h"
#include "pipelines/local_map/path/runs.h"

namespace cairn::local_map {

// Takes the walls' orientation out of the scans' headings, so that walls lie along the axes, and turns each
// way between two scans likewise, and makes it `scale` times as long. `walls`: of each scan, in the frame
// of its pose.
void Correct(const OrientationTrack& walls, double scale, std::vector<Scan>* scans);

}  // namespace cairn::local_map
