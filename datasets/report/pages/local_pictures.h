// The pictures of [DM98] figures 2 to 4.
#pragma once

#include <optional>
#include <vector>

#include "datasets/report/drawing/picture.h"
#include "datasets/report/pages/local_result.h"

namespace cairn::datasets::report {

// Figure 2: hit frequency in shades, a line in each cell that has a dominant orientation, the edges of the
// last scan, and below the histogram of wall orientations with its peak.
Picture LocalGridPicture(const LocalSnapshot& shot);

// Figure 3: the path of the robot, and left and right of it the intervals of distance, bold where occupied;
// short lines where orientations differ.
Picture TracePicture(const LocalTrace& trace);

// Figure 4: what the local grids show at a time, over a trace that was recorded before.
struct Superposed {
  LocalSnapshot shot;
  LocalTrace trace;
  double z_m = 0, u_m = 0;  // where the robot was put in the trace
  double turn_rad = 0;      // from the grids' frame to the trace's
};
// The best of a result: snapshots at which matching had corrected a position in an earlier trace, those with
// most edges first; two at most. `odometry`: dead reckoning of each robot.
std::vector<Superposed> Superpositions(const LocalResult& result, const std::vector<Track>& odometry);
Picture SuperposedPicture(const std::vector<Superposed>& shown);

// Dead reckoning of each of the log's robots.
std::vector<Track> OdometryOf(const Blob& log);

// The snapshot that shows most: of those with the most edges in their last scan the one with most cells that
// have an orientation. Null where there is none.
const LocalSnapshot* RichestOf(const LocalResult& result);
const LocalTrace* LongestOf(const LocalResult& result);

}  // namespace cairn::datasets::report
