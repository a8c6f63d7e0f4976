// Matching whole occupancy grids by correlation: 'the heavy process', 'which is the normal procedure in the
// field' ([DM98] section 4.2). The baseline for matching by traces.
#pragma once

#include <vector>

#include "pipelines/local_map/grids/local_grids.h"
#include "pipelines/local_map/traces/edge_trace.h"
#include "pipelines/local_map/traces/frame.h"
#include "pipelines/local_map/traces/match.h"

namespace cairn::local_map {

// Occupancy in a trace's frame: the share of the scans in which each cell was occupied.
class GridMap {
 public:
  // Cells with z in [first_z, first_z + size_z) and |u| <= half_u.
  GridMap(double cell_m, int first_z, int size_z, int half_u);

  // One more scan of which `frame` is the trace's. What lies outside is left out.
  void Add(const LocalGrids& grids, const TraceFrame& frame);

  double cell_m() const { return cell_m_; }
  int first_z() const { return first_z_; }
  int end_z() const { return first_z_ + size_z_; }
  int half_u() const { return half_u_; }
  // 0 outside and where nothing was seen.
  float At(int z, int u) const {
    if (z < first_z_ || z >= end_z() || u < -half_u_ || u > half_u_) return 0;
    const Cell& cell = cells_[IndexOf(z, u)];
    return cell.seen > 0 ? cell.occupied / cell.seen : 0;
  }

 private:
  struct Cell {
    float occupied = 0, seen = 0;
  };
  std::size_t IndexOf(int z, int u) const {
    return static_cast<std::size_t>(z - first_z_) * static_cast<std::size_t>(2 * half_u_ + 1) +
           static_cast<std::size_t>(u + half_u_);
  }

  double cell_m_;
  int first_z_, size_z_, half_u_;
  std::vector<Cell> cells_;
};

// Of one scan's grids, in the frame of the immediate trace of direction `quarter`.
GridMap MapOfNow(const LocalGrids& grids, int quarter);

// The position, in steps of a cell around `at` and then between them, that maximises
//   sum map * now / sqrt(sum map^2 sum now^2)
// over the cells of `now`. `robot`: in the frame of `now`. Costs (range.z / cell) (range.u / cell) cells of
// `now`.
Position CorrelateGrids(const GridMap& map, const GridMap& now, const Position& robot, const Position& at,
                        const SearchWindow& range);

}  // namespace cairn::local_map
