#include "pipelines/common/beam_cells.h"

#include <tuple>

namespace cairn {
namespace {

// Cuts [first, last] to where start + t u lies in [low, high].
void Clip(double start, double u, double low, double high, RayPart* part) {
  if (u == 0) {
    if (start < low || start >= high) part->last_m = -1;
    return;
  }
  const double a = (low - start) / u, b = (high - start) / u;
  part->first_m = std::max(part->first_m, std::min(a, b));
  part->last_m = std::min(part->last_m, std::max(a, b));
}

// Centres within the cone: by the half planes of its two edges and its reach.
void AddCone(const GridBox& box, const Pose& from, double opening_rad, double length_m,
             std::vector<BeamCell>* cells) {
  const double ux = std::cos(from.heading_rad), uy = std::sin(from.heading_rad);
  const double slope = std::tan(opening_rad / 2);
  const auto i0 = std::max<std::int64_t>(0, box.ColumnOf(from.x_m - length_m));
  const auto i1 = std::min(box.columns - 1, box.ColumnOf(from.x_m + length_m));
  const auto j0 = std::max<std::int64_t>(0, box.RowOf(from.y_m - length_m));
  const auto j1 = std::min(box.rows - 1, box.RowOf(from.y_m + length_m));
  for (std::int64_t j = j0; j <= j1; ++j) {
    const double dy = box.CentreY(j) - from.y_m;
    for (std::int64_t i = i0; i <= i1; ++i) {
      const double dx = box.CentreX(i) - from.x_m;
      const double along = dx * ux + dy * uy, across = std::abs(dx * uy - dy * ux);
      if (along <= 0 || across > along * slope) continue;
      const double distance = std::sqrt(dx * dx + dy * dy);
      if (distance <= length_m) cells->push_back({j * box.columns + i, distance});
    }
  }
}

bool Nearer(const BeamCell& a, const BeamCell& b) {
  return std::tie(a.distance_m, a.cell) < std::tie(b.distance_m, b.cell);
}

}  // namespace

RayPart ClipRay(const GridBox& box, const Pose& from, double length_m) {
  RayPart part{0, length_m};
  Clip(from.x_m, std::cos(from.heading_rad), box.origin_x_m,
       box.origin_x_m + static_cast<double>(box.columns) * box.cell_m, &part);
  Clip(from.y_m, std::sin(from.heading_rad), box.origin_y_m,
       box.origin_y_m + static_cast<double>(box.rows) * box.cell_m, &part);
  return part;
}

void BeamCells(const GridBox& box, const Pose& from, double opening_rad, double length_m,
               std::vector<BeamCell>* cells) {
  cells->clear();
  const double ux = std::cos(from.heading_rad), uy = std::sin(from.heading_rad);
  const auto along = [&](std::int64_t cell) {
    const double dx = box.CentreX(cell % box.columns) - from.x_m;
    const double dy = box.CentreY(cell / box.columns) - from.y_m;
    return opening_rad > 0 ? std::sqrt(dx * dx + dy * dy) : std::max(0.0, dx * ux + dy * uy);
  };
  if (opening_rad > 0) AddCone(box, from, opening_rad, length_m, cells);
  WalkRay(box, from, length_m,
          [&](std::int64_t cell, double, double) { cells->push_back({cell, along(cell)}); });
  std::ranges::sort(*cells, Nearer);
  const auto same = [](const BeamCell& a, const BeamCell& b) { return a.cell == b.cell; };
  cells->erase(std::ranges::unique(*cells, same).begin(), cells->end());
}

}  // namespace cairn
