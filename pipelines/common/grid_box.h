// Where a grid map (schema/geometry.h, GridBox) is to lie.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

#include "schema/geometry.h"

namespace cairn {

// Grows to hold points; `ToGrid` gives the box of whole cells, whose corners are multiples of the cell, so
// that maps of one log at one resolution lie on each other.
class Extent {
 public:
  void Add(double x_m, double y_m) {  // of each ray of a log
    if (empty()) x0_ = x1_ = x_m, y0_ = y1_ = y_m;
    x0_ = std::min(x0_, x_m);
    x1_ = std::max(x1_, x_m);
    y0_ = std::min(y0_, y_m);
    y1_ = std::max(y1_, y_m);
  }
  void Add(const Extent& other) {
    if (other.empty()) return;
    Add(other.x0_, other.y0_);
    Add(other.x1_, other.y1_);
  }
  void Grow(double margin_m);
  bool empty() const { return x1_ < x0_; }
  bool Holds(double x_m, double y_m) const { return x_m >= x0_ && x_m <= x1_ && y_m >= y0_ && y_m <= y1_; }
  double x0_m() const { return x0_; }
  double y0_m() const { return y0_; }
  double x1_m() const { return x1_; }
  double y1_m() const { return y1_; }
  // Throws InputError where it would have more than `most_cells`, and says how many and what to change.
  GridBox ToGrid(double cell_m, double most_cells) const;

 private:
  double x0_ = 1, y0_ = 1, x1_ = -1, y1_ = -1;
};

// "x0,y0,x1,y1" in metres.
// Throws InputError that names `option` where that is not four numbers, or x0 < x1 and y0 < y1 do not hold.
Extent ParseExtent(const std::string& option, const std::string& text);

}  // namespace cairn
