// Rectangles that a map is cut into, so that the search of each is about the same work.
#pragma once

#include <cstdint>
#include <vector>

#include "pipelines/common/range_scans.h"
#include "schema/blob.h"
#include "schema/kinds/fields.h"

namespace cairn::forward_map {

struct Tile {
  std::int32_t column = 0, row = 0, columns = 0, rows = 0;

  bool Holds(std::int64_t at_column, std::int64_t at_row) const {
    return at_column >= column && at_column < column + columns && at_row >= row && at_row < row + rows;
  }
  // Throws InputError where it does not lie in the grid, or is larger than one counts.
  void Check(const GridBox& grid) const;
  friend bool operator==(const Tile&, const Tile&) = default;
  static void Fields(const auto& field) {
    field("column", &Tile::column);
    field("row", &Tile::row);
    field("columns", &Tile::columns);
    field("rows", &Tile::rows);
  }
};

// How many beams meet how many cells, in blocks of kBlock x kBlock cells; estimated from some of the scans.
struct Load {
  std::int32_t columns = 0, rows = 0;  // of the grid, in cells
  std::vector<double> crossings;       // [block rows][block columns]

  static constexpr std::int32_t kBlock = 16;
  std::int32_t block_columns() const { return (columns + kBlock - 1) / kBlock; }
  std::int32_t block_rows() const { return (rows + kBlock - 1) / kBlock; }
  double Sum() const;
};
Load EstimateLoad(const std::vector<RangeScans>& sensors, const GridBox& box, double beyond_m);

// Cuts the grid in two, each part again, until none has more than `most` crossings or is a block; each cut
// leaves `share` of the work on its lower side, so that other shares have other borders. In a fixed order.
std::vector<Tile> CutTiles(const Load& load, double most, double share);

}  // namespace cairn::forward_map
