// Whether a grid map shows a door's opening as one that can be driven through.
#pragma once

#include "datasets/common/occupancy.h"
#include "datasets/common/walls.h"

namespace cairn::datasets {

inline constexpr double kPassageM = 0.2;   // a door counts as open where so wide a body gets through
inline constexpr double kThroughM = 0.25;  // from so far before the opening to so far behind it

// The largest edge of a square of free cells that can be moved through the opening `door` cell by cell,
// without leaving the strip as wide as the opening; 0: none. In steps of the cell's edge.
double PassageM(const Occupancy& map, const Wall& door);

}  // namespace cairn::datasets
