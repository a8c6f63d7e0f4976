// Edges from the hits of a scan and the occupancy grid: [DM98] figure 1, steps 1 to 5.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pipelines/local_map/grids/edge.h"
#include "pipelines/local_map/grids/grid_options.h"
#include "pipelines/local_map/grids/occupancy_grid.h"

namespace cairn::local_map {

// Sums over points in the frame of a candidate segment: x along it.
struct LineSums {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  void Add(double along, double across) {
    ++n;
    x += along;
    y += across;
    xx += along * along;
    xy += along * across;
    yy += across * across;
  }
};

// The angle between the frame's x axis and the line through the points' barycentre from which the sum of
// squared distances is least, in [-pi / 2, pi / 2]: tan(2 alpha) / 2 = sum xy / sum (x^2 - y^2), about the
// barycentre ([DM98] figure 1, step 5).
double CorrectedAngle(const LineSums& sums);

class LineFit {
 public:
  LineFit(const LineFitRule& rule, double cell_m);

  // Appends the edges that the hits of one ring's scan, in the order of its beams, give rise to; `closed`:
  // the last is a neighbour of the first. Appends no more than `edges` has room for without allocating.
  void Find(std::span<const Point> hits, bool closed, const OccupancyGrid& grid,
            std::vector<Edge>* edges) const;

 private:
  struct Segment {
    Point a, b;
  };
  bool Aligned(std::span<const Point> hits, std::size_t first, std::size_t last) const;
  void Enhance(const OccupancyGrid& grid, Segment* segment) const;
  bool Fit(const OccupancyGrid& grid, const Segment& segment, Edge* edge) const;
  bool Known(const Segment& segment, std::span<const Edge> edges) const;

  LineFitRule rule_;
  double hole_m_;
};

}  // namespace cairn::local_map
