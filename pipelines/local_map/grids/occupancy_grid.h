// The histogram grid: how often readings fell into each cell, recent ones more ([DM98] section 2).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "pipelines/local_map/grids/decay.h"
#include "pipelines/local_map/grids/plane.h"
#include "pipelines/local_map/grids/torus_grid.h"

namespace cairn::local_map {

class OccupancyGrid {
 public:
  // `kept`: the decay rate d, the fraction of a count that is kept each scan. `occupied`: the hit frequency
  // from which a cell counts as occupied.
  OccupancyGrid(double cell_m, int half, double kept, double occupied);

  double cell_m() const { return grid_.cell_m(); }
  int half() const { return grid_.half(); }
  CellIndex centre() const { return grid_.centre(); }
  Point robot() const { return grid_.robot(); }

  void MoveTo(double x_m, double y_m) { grid_.MoveTo(x_m, y_m); }
  // The next scan, so many ticks after the last: all counts decay. They do so when they are next looked at.
  void NextScan(std::int32_t ticks = kTicksPerScan) {
    tick_ += ticks;
    weight_ = decay_.Weight(ticks);
  }
  // A reading fell onto this point. False: it lies outside the window, and nothing happens.
  bool Hit(Point at) { return Put({at, weight_, tick_}); }

  // C(i, j) (1 - d), C as it stands after the hits of the scan: what share of the scans hits the cell. 0
  // where nothing is known.
  double Frequency(std::int32_t i, std::int32_t j) const;
  bool Occupied(std::int32_t i, std::int32_t j) const { return Frequency(i, j) >= occupied_; }
  // Where the last hit in the cell was, to sub-cell precision. Empty: nothing is known of the cell.
  std::optional<Point> LastHit(std::int32_t i, std::int32_t j) const;

  // visit(at) of the last hit of each cell of the block of cells that is occupied.
  template <class Visit>
  void ForOccupied(CellIndex low, CellIndex high, Visit&& visit) const {
    for (std::int32_t j = low.j; j <= high.j; ++j)
      for (std::int32_t i = low.i; i <= high.i; ++i)
        if (const Cell* cell = grid_.Find(i, j); cell && FrequencyOf(*cell) >= occupied_)
          visit(HitOf(i, j, *cell));
  }

  // Turns the contents counter-clockwise about the robot, which stays where it is: each cell goes where its
  // last hit goes. Counts that meet in a cell add up, and the later hit stays.
  void Turn(double angle_rad);

 private:
  struct Cell {
    float count = 0;         // as it was at `tick`
    std::int32_t tick = 0;   // of the last hit
    float x_m = 0, y_m = 0;  // the last hit, from the cell's middle
  };
  struct Moved {
    Point at;
    float count;
    std::int32_t tick;
  };

  // [DM98] section 2: C (1 - d)
  double FrequencyOf(const Cell& cell) const { return cell.count * decay_.After(tick_ - cell.tick) * share_; }
  Point HitOf(std::int32_t i, std::int32_t j, const Cell& cell) const {
    return {i * cell_m() + cell.x_m, j * cell_m() + cell.y_m};
  }
  bool Put(const Moved& moved);

  TorusGrid<Cell> grid_;
  Decay decay_;
  double share_, occupied_;
  std::int32_t tick_ = 0;
  float weight_ = 1;          // of a hit of this scan
  std::vector<Moved> moved_;  // for Turn; room for all cells from the start
};

}  // namespace cairn::local_map
