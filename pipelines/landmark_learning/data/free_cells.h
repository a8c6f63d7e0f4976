// Where a robot can go in an occupancy map, and how far it is.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "schema/blob.h"
#include "schema/geometry.h"

namespace cairn::landmark_learning {

class FreeCells {
 public:
  // From a map that was checked as its kind.
  // Throws InputError where it is no `grid_map`, or its grid has no cells.
  static FreeCells Of(const Blob& map);

  // The cell that holds a position; none where it is occupied or outside.
  std::optional<std::size_t> At(double x_m, double y_m) const;

  // The length of the shortest path to every cell, in metres (E. W. Dijkstra, A note on two problems in
  // connexion with graphs, 1959); infinite where there is none. A step goes to one of 16 cells around, if
  // what lies between is free.
  std::vector<double> PathLengthsFrom(std::size_t cell) const;

 private:
  bool IsFree(std::int64_t x, std::int64_t y) const { return box_.Holds(x, y) && free_[box_.Index(x, y)]; }
  bool CanStep(std::int64_t x, std::int64_t y, int dx, int dy) const;

  GridBox box_;
  std::vector<bool> free_;
};

}  // namespace cairn::landmark_learning
