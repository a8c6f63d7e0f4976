// Where a trace lies in a local frame.
#pragma once

#include <numbers>

#include "pipelines/local_map/grids/plane.h"
#include "pipelines/local_map/traces/edge_trace.h"

namespace cairn::local_map {

// The way runs along the local frame's x axis turned by `quarter` quarter turns (0 to 3) to the left; its
// origin is the middle of a cell.
struct TraceFrame {
  int quarter = 0;
  CellIndex origin;

  // The cell in column z and row u of the trace.
  CellIndex CellAt(int z, int u) const {
    switch (quarter) {
      case 0:
        return {origin.i + z, origin.j + u};
      case 1:
        return {origin.i - u, origin.j + z};
      case 2:
        return {origin.i - z, origin.j - u};
      default:
        return {origin.i + u, origin.j - z};
    }
  }

  Position At(const Point& local, double cell_m) const {
    const double x = local.x_m - origin.i * cell_m, y = local.y_m - origin.j * cell_m;
    switch (quarter) {
      case 0:
        return {x, y};
      case 1:
        return {y, -x};
      case 2:
        return {-x, -y};
      default:
        return {-y, x};
    }
  }

  Point Local(const Position& at, double cell_m) const {
    const double x = origin.i * cell_m, y = origin.j * cell_m;
    switch (quarter) {
      case 0:
        return {x + at.z_m, y + at.u_m};
      case 1:
        return {x - at.u_m, y + at.z_m};
      case 2:
        return {x - at.z_m, y - at.u_m};
      default:
        return {x + at.u_m, y - at.z_m};
    }
  }

  // That of the same way, driven back: z and u change their signs.
  TraceFrame Back() const { return {(quarter + 2) % 4, origin}; }

  // A direction of the local frame from the z axis, modulo pi: in [-pi/2, pi/2].
  double Direction(double local_rad) const {
    return ModuloAngle(local_rad - quarter * std::numbers::pi / 2, std::numbers::pi);
  }
};

}  // namespace cairn::local_map
