// The edge grid: which way the edges go that were found in each cell, occupied or not ([DM98] section 3.3).
#pragma once

#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "pipelines/local_map/grids/angle_histogram.h"
#include "pipelines/local_map/grids/decay.h"
#include "pipelines/local_map/grids/edge.h"
#include "pipelines/local_map/grids/torus_grid.h"
#include "pipelines/local_map/grids/wall_orientation.h"

namespace cairn::local_map {

// An edge that goes through a cell.
struct CellEdge {
  double angle_rad = 0;  // in [-pi / 2, pi / 2]
  Point at;              // on the last edge that was found there, in the cell
  double weight = 0;     // scans in which one was found, recent ones more
};

class EdgeGrid {
 public:
  static constexpr double kPeriodRad = std::numbers::pi;

  // `kept`: the fraction of the histograms that is kept each scan: more than of the occupancy grid's counts.
  EdgeGrid(double cell_m, int half, double kept, PeakRule rule);

  double cell_m() const { return grid_.cell_m(); }
  int half() const { return grid_.half(); }
  CellIndex centre() const { return grid_.centre(); }

  void MoveTo(double x_m, double y_m) { grid_.MoveTo(x_m, y_m); }
  // The next scan, so many ticks after the last, in which these edges were found: each counts in the cells
  // that it goes through.
  void Add(std::span<const Edge> edges, std::int32_t ticks = kTicksPerScan);

  // The dominant edge of a cell; none where no direction is strong.
  std::optional<CellEdge> Dominant(std::int32_t i, std::int32_t j) const;

  // Turns the contents counter-clockwise about the robot.
  void Turn(double angle_rad);

 private:
  struct Cell {
    AngleHistogram histogram;  // as it was at `tick`
    std::int32_t tick = 0;     // of the last edge
    float x_m = 0, y_m = 0;    // a point of that edge, from the cell's middle
  };
  struct Moved {
    Point at;
    AngleHistogram histogram;
    std::int32_t tick;
  };
  void Put(const Moved& moved);
  void AddEdge(const Edge& edge, float weight);

  TorusGrid<Cell> grid_;
  Decay decay_;
  PeakRule rule_;
  std::int32_t tick_ = 0;
  std::vector<Moved> moved_;  // for Turn; room for all cells from the start
};

}  // namespace cairn::local_map
