// An occupancy grid as it is scored: what each cell is, and how sure that is.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "schema/blob.h"
#include "schema/geometry.h"

namespace cairn::datasets {

// The cell that lies so many cells from the first one's edge. What is farther than any map reaches is that
// far: no number is too large for an index.
inline std::int64_t CellAt(double cells) {
  constexpr double kFar = 1e12;
  return static_cast<std::int64_t>(std::floor(std::clamp(cells, -kFar, kFar)));
}

// Cells of a map. Row 0 is the lowest y.
struct CellBox {
  double origin_x_m = 0, origin_y_m = 0, cell_m = 1;
  std::int64_t columns = 0, rows = 0;

  std::int64_t Column(double x_m) const { return CellAt((x_m - origin_x_m) / cell_m); }
  std::int64_t Row(double y_m) const { return CellAt((y_m - origin_y_m) / cell_m); }
  bool Holds(std::int64_t column, std::int64_t row) const {
    return column >= 0 && column < columns && row >= 0 && row < rows;
  }
  std::size_t Index(std::int64_t column, std::int64_t row) const {
    return static_cast<std::size_t>(row * columns + column);
  }
  Point Centre(std::int64_t column, std::int64_t row) const {
    return {origin_x_m + (static_cast<double>(column) + 0.5) * cell_m,
            origin_y_m + (static_cast<double>(row) + 0.5) * cell_m};
  }
  std::size_t cells() const { return static_cast<std::size_t>(columns * rows); }
};

struct Occupancy {
  CellBox box;
  std::vector<double> probability;  // of each cell being occupied; NaN: nothing is known of it

  bool IsOccupied(std::int64_t column, std::int64_t row) const {
    return box.Holds(column, row) && probability[box.Index(column, row)] > 0.5;
  }
  bool IsFree(std::int64_t column, std::int64_t row) const {
    return box.Holds(column, row) && probability[box.Index(column, row)] < 0.5;
  }
};

// A difference of log-likelihoods nearer to 0 than this says nothing of a cell.
inline constexpr double kSaysNothingNats = 0.01;

// `map/grid/probability` of a grid_map, or its most likely map, `map/grid/occupied`, as 0 and 1. Nothing is
// known where the probability is NaN, and where `log_odds_difference` is there and says nothing.
// Throws InputError that names the array: missing, of another shape, a probability beyond [0, 1].
Occupancy ReadOccupancy(const Blob& map);
Occupancy ReadMostLikely(const Blob& map);
bool HasMostLikely(const Blob& map);

}  // namespace cairn::datasets
