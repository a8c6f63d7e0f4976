#include "datasets/evaluate/maps/truth.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

namespace cairn::datasets {
namespace {

constexpr double kSpacing = 0.125;  // of points along a wall, in cells

// `map` grown by whole cells until it holds all ends.
GridBox Grown(const GridBox& map, const std::vector<Wall>& walls, MapTruth* truth) {
  std::int64_t left = 0, low = 0, right = map.columns, high = map.rows;
  for (const Wall& wall : walls) {
    for (const Point end : {wall.a, wall.b}) {
      left = std::min(left, map.ColumnOf(end.x_m));
      right = std::max(right, map.ColumnOf(end.x_m) + 1);
      low = std::min(low, map.RowOf(end.y_m));
      high = std::max(high, map.RowOf(end.y_m) + 1);
    }
  }
  truth->offset_columns = -left;
  truth->offset_rows = -low;
  GridBox box = map;
  box.origin_x_m += static_cast<double>(left) * map.cell_m;
  box.origin_y_m += static_cast<double>(low) * map.cell_m;
  box.columns = right - left;
  box.rows = high - low;
  constexpr std::int64_t kMostCells = 100'000'000;  // 300 MB
  if (box.columns > kMostCells / box.rows)
    throw InputError("map and true walls, laid over each other by the true poses, take " +
                     std::to_string(box.columns) + " x " + std::to_string(box.rows) +
                     " cells; allowed: " + std::to_string(kMostCells) +
                     " all together. Is a true pose or a wall far from where it should be?");
  return box;
}

// Points along the wall, as far apart; of those a few farther from `near` than `within_m` too, most are left
// out.
void ForPointsOf(const Wall& wall, double spacing_m, Point near, double within_m,
                 const std::function<void(Point)>& visit) {
  const double length_m = DistanceM(wall.a, wall.b);
  const auto steps = static_cast<std::int64_t>(std::ceil(length_m / spacing_m));
  std::int64_t first = 0, last = steps;
  if (steps > 0 && std::isfinite(within_m)) {
    const double along = ((near.x_m - wall.a.x_m) * (wall.b.x_m - wall.a.x_m) +
                          (near.y_m - wall.a.y_m) * (wall.b.y_m - wall.a.y_m)) /
                         (length_m * length_m);
    const double reach = within_m / length_m, of_steps = static_cast<double>(steps);
    first = std::max<std::int64_t>(0, static_cast<std::int64_t>(std::floor((along - reach) * of_steps)) - 1);
    last =
        std::min<std::int64_t>(steps, static_cast<std::int64_t>(std::ceil((along + reach) * of_steps)) + 1);
  }
  for (std::int64_t i = first; i <= last; ++i) {
    const double t = steps == 0 ? 0 : static_cast<double>(i) / static_cast<double>(steps);
    visit({wall.a.x_m + t * (wall.b.x_m - wall.a.x_m), wall.a.y_m + t * (wall.b.y_m - wall.a.y_m)});
  }
}

void Mark(const GridBox& box, Point at, std::vector<std::uint8_t>* cells) {
  const std::int64_t column = box.ColumnOf(at.x_m), row = box.RowOf(at.y_m);
  if (box.Holds(column, row)) (*cells)[box.Index(column, row)] = 1;
}

bool SeenInCone(const Pose& from, double half_rad, double within_m, Point at) {
  const double dx = at.x_m - from.x_m, dy = at.y_m - from.y_m;
  if (dx * dx + dy * dy > within_m * within_m) return false;
  return std::abs(WrapAngle(std::atan2(dy, dx) - from.heading_rad)) <= half_rad;
}

// The wall cells that a beam tells of.
void MarkDue(const std::vector<Wall>& walls, const Pose& beam, double half_rad, double reach_m,
             MapTruth* truth) {
  const Point at{beam.x_m, beam.y_m};
  std::vector<double> nearest_m;
  double nearest = std::numeric_limits<double>::infinity();
  for (const Wall& wall : walls) {
    nearest_m.push_back(NearestWallM({wall}, at, beam.heading_rad, half_rad));
    nearest = std::min(nearest, nearest_m.back());
  }
  if (nearest > reach_m) return;
  if (half_rad == 0) {
    Mark(truth->box,
         {at.x_m + nearest * std::cos(beam.heading_rad), at.y_m + nearest * std::sin(beam.heading_rad)},
         &truth->due);
    return;
  }
  const double within_m = nearest + truth->box.cell_m;
  for (std::size_t w = 0; w < walls.size(); ++w) {
    if (nearest_m[w] > within_m) continue;
    ForPointsOf(walls[w], kSpacing * truth->box.cell_m, at, within_m, [&](Point point) {
      if (SeenInCone(beam, half_rad, within_m, point)) Mark(truth->box, point, &truth->due);
    });
  }
}

// Marks as free what is reached from these cells without crossing a wall, ring after ring: a ring is all that
// is held.
void FloodFrom(const std::vector<std::pair<std::int64_t, std::int64_t>>& starts, MapTruth* truth) {
  const GridBox& box = truth->box;
  std::vector<std::pair<std::int64_t, std::int64_t>> ring, next;
  const auto reach = [&](std::int64_t column, std::int64_t row) {
    if (!box.Holds(column, row)) return;
    const std::size_t cell = box.Index(column, row);
    if (truth->wall[cell] != 0 || truth->free[cell] != 0) return;
    truth->free[cell] = 1;
    next.emplace_back(column, row);
  };
  for (const auto& [column, row] : starts) reach(column, row);
  while (!next.empty()) {
    ring.swap(next);
    next.clear();
    for (const auto& [column, row] : ring) {
      reach(column + 1, row);
      reach(column - 1, row);
      reach(column, row + 1);
      reach(column, row - 1);
    }
  }
}

std::string SpanOf(const GridBox& box) {
  return fmt::format("x from {:.4g} to {:.4g} m, y from {:.4g} to {:.4g} m", box.origin_x_m,
                     box.origin_x_m + static_cast<double>(box.columns) * box.cell_m, box.origin_y_m,
                     box.origin_y_m + static_cast<double>(box.rows) * box.cell_m);
}

void RequireCommon(const GridBox& map, const GridBox& reference, const MapTruth& truth) {
  const auto told = [](const std::vector<std::uint8_t>& cells) { return std::ranges::count(cells, 1) > 0; };
  if (told(truth.wall) || told(truth.free)) return;
  throw InputError("the map that this one is held against tells of none of its cells: it covers " +
                   SpanOf(reference) + ", this one " + SpanOf(map) + ". Are both in one frame?");
}

// Whether `is` holds of the cell or of one of the eight beside it.
template <class Is>
bool NearWall(std::int64_t column, std::int64_t row, const Is& is) {
  for (std::int64_t y = row - 1; y <= row + 1; ++y) {
    for (std::int64_t x = column - 1; x <= column + 1; ++x)
      if (is(x, y)) return true;
  }
  return false;
}

}  // namespace

MapTruth TruthOfWalls(const GridBox& map, const std::vector<Wall>& walls,
                      const std::vector<ScoredSensor>& scans) {
  MapTruth truth;
  truth.box = Grown(map, walls, &truth);
  truth.wall = truth.due = truth.free = std::vector<std::uint8_t>(truth.box.cells(), 0);
  for (const Wall& wall : walls)
    ForPointsOf(wall, kSpacing * map.cell_m, {}, std::numeric_limits<double>::infinity(),
                [&](Point at) { Mark(truth.box, at, &truth.wall); });
  std::vector<std::pair<std::int64_t, std::int64_t>> path;
  for (const ScoredSensor& sensor : scans) {
    for (std::size_t scan = 0; scan < sensor.poses.size(); ++scan) {
      path.emplace_back(truth.box.ColumnOf(sensor.poses[scan].x_m), truth.box.RowOf(sensor.poses[scan].y_m));
      if (sensor.held_out[scan] != 0) continue;
      for (std::size_t beam = 0; beam < sensor.beams.size(); ++beam)
        MarkDue(walls, sensor.BeamPose(scan, beam), sensor.opening_rad / 2, sensor.max_range_m, &truth);
    }
  }
  FloodFrom(path, &truth);
  return truth;
}

MapTruth TruthOfMap(const GridBox& map, const Occupancy& reference) {
  MapTruth truth;
  truth.box = map;
  truth.wall = truth.free = std::vector<std::uint8_t>(map.cells(), 0);
  for (std::int64_t row = 0; row < map.rows; ++row) {
    for (std::int64_t column = 0; column < map.columns; ++column) {
      const Point at = map.Centre(column, row);
      const std::int64_t x = reference.box.ColumnOf(at.x_m), y = reference.box.RowOf(at.y_m);
      truth.wall[map.Index(column, row)] = reference.IsOccupied(x, y) ? 1 : 0;
      truth.free[map.Index(column, row)] = reference.IsFree(x, y) ? 1 : 0;
    }
  }
  const bool is_finer = reference.box.cell_m < map.cell_m * (1 - 1e-9);
  for (std::int64_t y = 0; is_finer && y < reference.box.rows; ++y) {
    for (std::int64_t x = 0; x < reference.box.columns; ++x) {
      const Point at = reference.box.Centre(x, y);
      const std::int64_t column = map.ColumnOf(at.x_m), row = map.RowOf(at.y_m);
      if (!map.Holds(column, row)) continue;
      truth.wall[map.Index(column, row)] |= reference.IsOccupied(x, y) ? 1 : 0;
      truth.free[map.Index(column, row)] |= reference.IsFree(x, y) ? 1 : 0;
    }
  }
  for (std::size_t cell = 0; cell < truth.wall.size(); ++cell)
    if (truth.wall[cell] != 0) truth.free[cell] = 0;
  RequireCommon(map, reference.box, truth);
  truth.due = truth.wall;
  return truth;
}

std::vector<Wall> ReadSegments(const Blob& log, const std::string& prefix, const Similarity& to_map) {
  const auto x = log.Get<double>(prefix + "x_m"), y = log.Get<double>(prefix + "y_m");
  if (x.size() != y.size() || x.size() % 2 != 0) throw InputError("'" + prefix + "': each row has two ends");
  std::vector<Wall> walls;
  for (std::size_t i = 0; i < x.size(); i += 2)
    walls.push_back({to_map(Point{x[i], y[i]}), to_map(Point{x[i + 1], y[i + 1]})});
  return walls;
}

CellScore ScoreCells(const Occupancy& map, const MapTruth& truth) {
  CellScore score;
  const auto wall = [&](std::int64_t x, std::int64_t y) {
    return truth.box.Holds(x, y) && truth.wall[truth.box.Index(x, y)] != 0;
  };
  const auto occupied = [&](std::int64_t x, std::int64_t y) {
    return map.IsOccupied(x - truth.offset_columns, y - truth.offset_rows);
  };
  const auto free = [&](std::int64_t x, std::int64_t y) {
    return map.IsFree(x - truth.offset_columns, y - truth.offset_rows);
  };
  for (std::int64_t row = 0; row < truth.box.rows; ++row) {
    for (std::int64_t column = 0; column < truth.box.columns; ++column) {
      const std::size_t cell = truth.box.Index(column, row);
      score.free += truth.free[cell];
      score.due += truth.due[cell];
      if (truth.due[cell] != 0 && !NearWall(column, row, occupied)) {
        ++score.missed_occupied;
        score.missed_free += free(column, row) ? 1 : 0;
      }
      if (!occupied(column, row) || NearWall(column, row, wall)) continue;
      ++(truth.free[cell] != 0 ? score.false_occupied : score.beyond_walls);
    }
  }
  return score;
}

}  // namespace cairn::datasets
