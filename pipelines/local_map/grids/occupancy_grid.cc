#include "pipelines/local_map/grids/occupancy_grid.h"

#include <algorithm>
#include <cmath>

namespace cairn::local_map {

OccupancyGrid::OccupancyGrid(double cell_m, int half, double kept, double occupied)
    : grid_(cell_m, half), decay_(kept), share_(1 - kept), occupied_(occupied) {
  const auto edge = static_cast<std::size_t>(2 * half + 1);
  moved_.reserve(edge * edge);
}

// The counts of both as they are at the later of the two scans.
bool OccupancyGrid::Put(const Moved& moved) {
  const std::int32_t i = CellOf(moved.at.x_m, cell_m()), j = CellOf(moved.at.y_m, cell_m());
  Cell* cell = grid_.Touch(i, j);
  if (!cell) return false;
  const bool later = moved.tick >= cell->tick;
  const std::int32_t tick = later ? moved.tick : cell->tick;
  // [DM98] section 2: C(i, j), with decay
  cell->count = cell->count * decay_.After(tick - cell->tick) + moved.count * decay_.After(tick - moved.tick);
  cell->tick = tick;
  if (!later) return true;
  // [DM98] section 2.2: the last hit, relative to the cell's centre
  cell->x_m = static_cast<float>(moved.at.x_m - i * cell_m());
  cell->y_m = static_cast<float>(moved.at.y_m - j * cell_m());
  return true;
}

double OccupancyGrid::Frequency(std::int32_t i, std::int32_t j) const {
  const Cell* cell = grid_.Find(i, j);
  return cell ? FrequencyOf(*cell) : 0;
}

std::optional<Point> OccupancyGrid::LastHit(std::int32_t i, std::int32_t j) const {
  const Cell* cell = grid_.Find(i, j);
  if (!cell) return std::nullopt;
  return HitOf(i, j, *cell);
}

void OccupancyGrid::Turn(double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  moved_.clear();
  grid_.ForEach([&](std::int32_t i, std::int32_t j, const Cell& cell) {
    const Point hit = HitOf(i, j, cell);
    const double x = hit.x_m - robot().x_m, y = hit.y_m - robot().y_m;
    // [DM98] section 2.2: a rotation by the last hits
    moved_.push_back({{robot().x_m + c * x - s * y, robot().y_m + s * x + c * y}, cell.count, cell.tick});
  });
  grid_.Clear();
  for (const Moved& moved : moved_) Put(moved);
}

}  // namespace cairn::local_map
