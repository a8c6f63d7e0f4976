// How often each cell was said to be free, and to be occupied: all that the sum of log-odds needs, and exact
// however the readings are cut into tasks.
#pragma once

#include <cstdint>
#include <vector>

#include "pipelines/common/grid_box.h"
#include "pipelines/common/range_scans.h"

namespace cairn::evidence_map {

// A reading of a cone counts in whole parts of this, as it says less of some cells than of others.
inline constexpr std::int32_t kWhole = 256;

// Of a window of the map's grid, which may reach beyond it by one cell.
struct Counts {
  GridBox box;
  std::int64_t first_column = 0, first_row = 0;  // of the box, in the grid
  std::vector<std::int32_t> free, occupied;      // [rows][columns]
};

// None yet, of the window that readings of these scans reach, with a cell around it.
Counts CountsFor(const RangeScans& scans, const GridBox& grid, double beyond_m);

// As a task's partial, which is small, for each brings home a map: of how often a cell was free the lowest 16
// bits in two arrays of bytes (packed), what is beyond in whole 65536ths by the cell's number in the window,
// and how often it was occupied by its number too; few cells ever are, or are free so often. Where few are
// free 256 times there is but one array of bytes, and what is beyond comes in whole 256ths.
Blob ToBlob(const Counts& counts);

// Adds a partial to the counts of the whole grid; what lies outside of it falls away.
struct Totals {
  std::vector<std::int64_t> free, occupied;  // [cells of the grid]
};
void AddTo(const GridBox& grid, const Blob& partial, Totals* totals);

}  // namespace cairn::evidence_map
