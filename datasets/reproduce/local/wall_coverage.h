// How much of the walls about a robot its local grids show: by cells that are hit, and by edges ([DM98]
// sections 3.3 and 3.4, of walls that are metallic).
#pragma once

#include "schema/blob.h"

namespace cairn::datasets {

struct WallCoverage {
  double wall_m = 0, by_edges_m = 0, by_hits_m = 0;  // of the walls that were looked at
  double by_either_m = 0;
  void Add(const WallCoverage& other);
};

// Of the smooth walls within 2 m of the robot, at the snapshots that it was between them: what lies within a
// cell of a cell with an orientation; of one that a tenth of the scans hit, or more. `result`: a local_map
// of the log `log`, with truth.
WallCoverage MetallicCoverage(const Blob& result, const Blob& log);

}  // namespace cairn::datasets
