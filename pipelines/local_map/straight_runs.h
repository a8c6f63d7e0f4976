// Where a path goes straight along one of the four directions of the walls: what traces are recorded over.
#pragma once

#include <cstddef>
#include <vector>

#include "pipelines/common/pose.h"

namespace cairn::local_map {

struct StraightRunOptions {
  double direction_rad = 0.6;  // a heading so far off the axis is still along it
  double least_m = 1.0;        // of way along the axis
  double most_m = 12;          // longer ones are cut, as odometry's errors add up within a trace
};

struct StraightRun {
  std::size_t first = 0, end = 0;  // sweeps
  int quarter = 0;                 // direction: times pi / 2
};

// Of sweeps [first, end) of one run, whose poses are in the frame of the walls. They do not overlap; what
// lies between them are turns and ways across. `hints`: sweeps before which a trace ends.
std::vector<StraightRun> StraightRunsOf(const std::vector<Pose>& poses, std::size_t first, std::size_t end,
                                        const std::vector<std::size_t>& hints,
                                        const StraightRunOptions& options);

// 0 to 3: the axis that is nearest to a heading.
int QuarterOf(double heading_rad);

}  // namespace cairn::local_map
