// The walls of a corridor world.
#pragma once

#include <vector>

#include "datasets/common/walls.h"
#include "datasets/simulate/world.h"

namespace cairn::datasets {

// From a corridor's axis to its walls. Robots in a hurry cut corners by up to 2 m.
inline constexpr double kCorridorHalfWidthM = 2.2;

// The outline of all corridors together. A corridor is the rectangle round its axis, half a width longer at
// each end; where corridors meet, what lies inside another is no wall.
std::vector<Wall> WallsOf(const CorridorWorld& world);

}  // namespace cairn::datasets
