// Points of a local frame, and the cells of its grids: cell (i, j) is the square of edge cell_m centred on
// (i cell_m, j cell_m).
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "schema/geometry.h"

namespace cairn::local_map {

// std::hypot takes several times as long, for lengths near the ends of what a double holds.
inline double FastDistanceM(Point a, Point b) {
  const double x = b.x_m - a.x_m, y = b.y_m - a.y_m;
  return std::sqrt(x * x + y * y);
}

struct CellIndex {
  std::int32_t i = 0, j = 0;
  bool operator==(const CellIndex&) const = default;
};

// Which cell holds a coordinate: at most 2^31 cells from the origin.
inline std::int32_t CellOf(double at_m, double cell_m) {
  return static_cast<std::int32_t>(std::floor(at_m / cell_m + 0.5));
}

// The angle of a line into [-period / 2, period / 2]: pi for directions of lines, pi / 2 for those of walls
// at square angles.
inline double ModuloAngle(double angle_rad, double period_rad) {
  return std::remainder(angle_rad, period_rad);
}

inline double RadOf(double deg) { return deg * std::numbers::pi / 180; }
inline double DegOf(double rad) { return rad * 180 / std::numbers::pi; }

}  // namespace cairn::local_map
