#include "datasets/reproduce/occupancy/scores.h"

#include <cmath>

namespace cairn::datasets {
namespace {

bool OccupiedNear(const Occupancy& map, Point at) {
  const std::int64_t column = map.box.ColumnOf(at.x_m), row = map.box.RowOf(at.y_m);
  for (std::int64_t y = row - 1; y <= row + 1; ++y) {
    for (std::int64_t x = column - 1; x <= column + 1; ++x)
      if (map.IsOccupied(x, y)) return true;
  }
  return false;
}

}  // namespace

double WallFound(const Occupancy& map, const Wall& wall, double from_m, double to_m) {
  double points = 0, found = 0;
  const double step = map.box.cell_m / 2 / DistanceM(wall.a, wall.b);
  for (double t = 0; t <= 1; t += step) {
    const Point at{wall.a.x_m + t * (wall.b.x_m - wall.a.x_m), wall.a.y_m + t * (wall.b.y_m - wall.a.y_m)};
    if (at.x_m < from_m || at.x_m > to_m) continue;
    points += 1;
    found += OccupiedNear(map, at) ? 1 : 0;
  }
  return points > 0 ? found / points : 0;
}

double Stripes(const Occupancy& map, double wall_m, double from_m, double to_m) {
  const double side = wall_m > 0 ? -1 : 1;
  double sum = 0, pairs = 0;
  for (double off = 0.15; off <= 0.75; off += map.box.cell_m) {
    const std::int64_t row = map.box.RowOf(wall_m + side * off);
    for (std::int64_t column = map.box.ColumnOf(from_m); column < map.box.ColumnOf(to_m); ++column) {
      if (!map.box.Holds(column, row) || !map.box.Holds(column + 1, row)) continue;
      const double a = map.probability[map.box.Index(column, row)],
                   b = map.probability[map.box.Index(column + 1, row)];
      if (std::isnan(a) || std::isnan(b)) continue;
      sum += std::abs(a - b);
      pairs += 1;
    }
  }
  return pairs > 0 ? sum / pairs : 0;
}

void HallScores::Add(const LayerScore& layer, double stripes_here) {
  ++maps;
  bool right = true;
  for (const DoorScore& door : layer.doors) right = right && door.open == door.truly_open;
  doors_right += right ? 1 : 0;
  if (layer.cells) {
    false_occupied += static_cast<double>(layer.cells->false_occupied);
    missed += static_cast<double>(layer.cells->missed_occupied);
    missed_free += static_cast<double>(layer.cells->missed_free);
    due += static_cast<double>(layer.cells->due);
  }
  stripes += stripes_here;
}

}  // namespace cairn::datasets
