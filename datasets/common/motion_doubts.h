// Whether what a robot sees moves as its odometry says: walls ahead come nearer by what was driven, and all
// turns the other way round when the robot turns. Where odometry is mirrored, backwards, in another unit, or
// kept by another clock, pairs of scans, or of observations of landmarks, soon after each other show it,
// however badly it drifts: no map is needed.
#pragma once

#include <string>
#include <vector>

#include "schema/kinds/log.h"

namespace cairn::datasets {

// A sentence a sensor and mistake: "robot 'anna', its laser: what it sees turns the other way (of 312 pairs
// of scans); …". Nothing where there are too few pairs to tell. Of columns that are missing it says nothing.
std::vector<std::string> FindMotionDoubts(const kinds::Log& log);

}  // namespace cairn::datasets
