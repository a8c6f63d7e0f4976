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
  if (opening_rad > 0) {
    WalkCone(
        box, from, opening_rad, length_m, [](std::int64_t) { return true; },
        [&](std::int64_t cell, double distance_m) { cells->push_back({cell, distance_m}); });
  } else {
    const double ux = std::cos(from.heading_rad), uy = std::sin(from.heading_rad);
    WalkRay(box, from, length_m, [&](std::int64_t cell, double, double) {
      const double dx = box.CentreX(cell % box.columns) - from.x_m;
      const double dy = box.CentreY(cell / box.columns) - from.y_m;
      cells->push_back({cell, std::max(0.0, dx * ux + dy * uy)});
    });
  }
  std::ranges::sort(*cells, Nearer);
}

}  // namespace cairn
