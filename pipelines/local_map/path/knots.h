// Places along a path, close enough together that between them odometry's errors may be shared out evenly.
#pragma once

#include <cstddef>
#include <vector>

#include "pipelines/local_map/path/assemble.h"
#include "pipelines/local_map/path/runs.h"

namespace cairn::local_map {

struct KnotOptions {
  double apart_m = 0.5;
  double along_sd = 0.01;   // of the way between two, a fraction of its square root's metre
  double across_sd = 0.02;  // to its side, likewise
  double gap_m = 0.3;       // sd across a gap in time
  double jump_m = 2;        // sd across a jump of odometry
};

// Of one robot, the first sweep of each run and then one every apart_m of way; the last sweep too.
std::vector<std::size_t> KnotsOf(const std::vector<Sweep>& sweeps, const KnotOptions& options);

// From each of these knots to the next, by the sweeps' poses. `first`: the number of the first knot.
std::vector<Leg> LegsOf(const std::vector<Sweep>& sweeps, const std::vector<std::size_t>& knots,
                        std::int32_t first, const KnotOptions& options);

// The sweeps' poses with the knots where `placed` says; what it moves them by is shared out over the way.
void MoveTo(const std::vector<std::size_t>& knots, const Point* placed, std::vector<Sweep>* sweeps);

}  // namespace cairn::local_map
