// Traces by hand, for tests: what a robot without errors would record between two walls with steps and ends.
#pragma once

#include <cmath>
#include <vector>

#include "pipelines/local_map/traces/edge_trace.h"

namespace cairn::local_map {

// A wall on one side: from z on it lies at this distance; NaN: there is none.
struct WallFrom {
  double z_m, distance_m;
};

struct HandWorld {
  std::vector<WallFrom> left, right;            // in the order of z
  std::vector<double> cross_left, cross_right;  // z of edges across the way
};

inline Side HandSide(const std::vector<WallFrom>& walls, const std::vector<double>& cross, double z_m,
                     double nearer_m, double cell_m) {
  Side side;
  double distance_m = std::nan("");
  for (const WallFrom& wall : walls)
    if (wall.z_m <= z_m) distance_m = wall.distance_m;
  if (!std::isnan(distance_m)) {
    side.angle_rad = {0, 0};
    side.distance_m.Include(static_cast<float>(distance_m - nearer_m));
    side.occupied = 1;
  }
  for (const double at_m : cross)
    if (std::abs(at_m - z_m) <= cell_m / 2) {
      side.cross_m = static_cast<float>(at_m - z_m);
      side.cross_cells = 1;
    }
  return side;
}

// Features [first, end) as seen by a robot whose trace's origin lies at `origin` of the world.
inline EdgeTrace HandTrace(const HandWorld& world, const Position& origin, int first, int end,
                           double cell_m = 0.15) {
  EdgeTrace trace(cell_m, first, static_cast<std::size_t>(end - first));
  for (int z = first; z < end; ++z) {
    const double z_m = origin.z_m + z * cell_m;
    *trace.Touch(z) = {HandSide(world.left, world.cross_left, z_m, origin.u_m, cell_m),
                       HandSide(world.right, world.cross_right, z_m, -origin.u_m, cell_m)};
  }
  return trace;
}

// A corridor 2 m wide with a niche on the left, a cupboard on the right and two edges across the way.
inline HandWorld Corridor() {
  return {{{-9, 1.0}, {2.0, 1.4}, {3.1, 1.0}}, {{-9, 1.0}, {0.5, 0.7}, {1.3, 1.0}}, {2.0, 3.1}, {0.5, 1.3}};
}

}  // namespace cairn::local_map
