// The cells that a range sensor's beam meets: those on a ray, or in a cone.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "pipelines/common/grid_box.h"
#include "schema/geometry.h"

namespace cairn {

struct BeamCell {
  std::int64_t cell;  // row * columns + column
  double distance_m;  // of the cell's centre from where the beam begins; on a ray, along it
};

// The part of a ray of `length_m` that lies in the grid: distances along it; empty where last <= first.
struct RayPart {
  double first_m, last_m;
};
RayPart ClipRay(const GridBox& box, const Pose& from, double length_m);

// Walks the cells whose area the ray crosses, in order, from the beam's beginning to `length_m` (J.
// Amanatides and A. Woo, A Fast Voxel Traversal Algorithm for Ray Tracing, Eurographics 1987). Cells outside
// the grid are passed over. visit(cell, enter_m, leave_m): distances along the ray.
template <class Visit>
void WalkRay(const GridBox& box, const Pose& from, double length_m, Visit&& visit) {
  const auto [first_m, last_m] = ClipRay(box, from, length_m);
  if (!(first_m < last_m)) return;
  const double ux = std::cos(from.heading_rad), uy = std::sin(from.heading_rad);
  constexpr double kNever = std::numeric_limits<double>::infinity();
  std::int64_t i = std::clamp<std::int64_t>(box.ColumnOf(from.x_m + first_m * ux), 0, box.columns - 1);
  std::int64_t j = std::clamp<std::int64_t>(box.RowOf(from.y_m + first_m * uy), 0, box.rows - 1);
  const std::int64_t step_i = ux > 0 ? 1 : -1, step_j = uy > 0 ? 1 : -1;
  // Where the ray crosses the next column's, the next row's border.
  const auto border = [&](double origin, std::int64_t index, double start, double u) {
    return u == 0 ? kNever : (origin + static_cast<double>(index + (u > 0)) * box.cell_m - start) / u;
  };
  double next_i = border(box.origin_x_m, i, from.x_m, ux), next_j = border(box.origin_y_m, j, from.y_m, uy);
  const double across_i = ux == 0 ? kNever : box.cell_m / std::abs(ux);
  const double across_j = uy == 0 ? kNever : box.cell_m / std::abs(uy);
  double at = first_m;
  while (at < last_m && box.Holds(i, j)) {
    const double leave = std::min({next_i, next_j, last_m});
    visit(j * box.columns + i, at, std::max(at, leave));
    at = std::max(at, leave);
    if (next_i < next_j) {
      i += step_i;
      next_i += across_i;
    } else {
      j += step_j;
      next_j += across_j;
    }
  }
}

// The cells that a beam of the full opening `opening_rad` (above 0) meets within `length_m`, each once, in no
// order of distance: those whose centre lies in the cone, and those on its axis, which near its tip is
// narrower than a cell; but only those of which wanted(cell) is true, which is asked first: distances cost
// more. visit(cell, distance_m) of the centre. Costs the cells visited, and a few a row.
template <class Wanted, class Visit>
void WalkCone(const GridBox& box, const Pose& from, double opening_rad, double length_m, Wanted&& wanted,
              Visit&& visit) {
  const double ux = std::cos(from.heading_rad), uy = std::sin(from.heading_rad);
  const double slope = std::tan(opening_rad / 2), square = length_m * length_m;
  const auto inside = [&](double dx, double dy) {
    const double along = dx * ux + dy * uy, across = std::abs(dx * uy - dy * ux);
    return along > 0 && across <= along * slope && dx * dx + dy * dy <= square;
  };
  const auto j0 = std::max<std::int64_t>(0, box.RowOf(from.y_m - length_m));
  const auto j1 = std::min(box.rows - 1, box.RowOf(from.y_m + length_m));
  for (std::int64_t j = j0; j <= j1; ++j) {
    const double dy = box.CentreY(j) - from.y_m;
    // Where the row lies between the cone's edges: |dx uy - dy ux| <= slope (dx ux + dy uy).
    double low = -length_m, high = length_m;
    const auto bound = [&](double factor, double most) {  // factor dx <= most
      if (factor > 0) high = std::min(high, most / factor);
      if (factor < 0) low = std::max(low, most / factor);
    };
    bound(uy - slope * ux, dy * (ux + slope * uy));
    bound(-uy - slope * ux, dy * (slope * uy - ux));
    if (!(low <= high + box.cell_m)) continue;
    const auto i0 = std::max<std::int64_t>(0, box.ColumnOf(from.x_m + low) - 1);
    const auto i1 = std::min(box.columns - 1, box.ColumnOf(from.x_m + high) + 1);
    for (std::int64_t i = i0; i <= i1; ++i) {
      if (!wanted(j * box.columns + i)) continue;
      const double dx = box.CentreX(i) - from.x_m;
      if (inside(dx, dy)) visit(j * box.columns + i, std::sqrt(dx * dx + dy * dy));
    }
  }
  WalkRay(box, from, length_m, [&](std::int64_t cell, double, double) {
    if (!wanted(cell)) return;
    const double dx = box.CentreX(cell % box.columns) - from.x_m;
    const double dy = box.CentreY(cell / box.columns) - from.y_m;
    if (!inside(dx, dy)) visit(cell, std::sqrt(dx * dx + dy * dy));
  });
}

// The cells of WalkCone, or on a ray (opening 0) those of WalkRay, by distance, equal distances by cell.
void BeamCells(const GridBox& box, const Pose& from, double opening_rad, double length_m,
               std::vector<BeamCell>* cells);

}  // namespace cairn
