// A robot's path with the headings that walls give.
#pragma once

#include <vector>

#include "pipelines/local_map/path/orientation_track.h"
#include "pipelines/local_map/path/runs.h"

namespace cairn::local_map {

// Takes the walls' orientation out of the sweeps' headings, so that walls lie along the axes, and turns each
// way between two sweeps likewise, and makes it `scale` times as long. `walls`: of each sweep, in the frame
// of its pose.
void Correct(const OrientationTrack& walls, double scale, std::vector<Sweep>* sweeps);

}  // namespace cairn::local_map
