// A piece of a wall, as the line fit finds it.
#pragma once

#include "pipelines/local_map/grids/plane.h"

namespace cairn::local_map {

struct Edge {
  Point a, b;
  double angle_rad = 0;  // of the line, in [-pi / 2, pi / 2]
  double sd_rad = 1;     // of that angle, were the hits' errors independent
  int hits = 0;          // that it was fitted to

  double LengthM() const { return FastDistanceM(a, b); }
};

}  // namespace cairn::local_map
