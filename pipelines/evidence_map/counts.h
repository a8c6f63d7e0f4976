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

// Adds them to those of the whole grid; what lies outside of it falls away.
struct Totals {
  std::vector<std::int64_t> free, occupied;  // [cells of the grid]
};
void AddTo(const GridBox& grid, const Counts& counts, Totals* totals);

// As a task's partial: few cells are ever occupied, so those by their numbers in the window.
Blob ToBlob(const Counts& counts);
Counts CountsOf(const Blob& blob);

}  // namespace cairn::evidence_map
