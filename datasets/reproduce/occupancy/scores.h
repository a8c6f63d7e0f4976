// What [Thr01] says of its maps in words, as numbers.
#pragma once

#include <cstdint>
#include <vector>

#include "datasets/evaluate/grid.h"
#include "schema/blob.h"

namespace cairn::datasets {

// The share of a wall's points, one every half cell, in or beside whose cell there is an occupied one; of its
// part from x = from_m to to_m.
double WallFound(const Occupancy& map, const Wall& wall, double from_m, double to_m);

// Stripes across a wall along x at y = wall_m: how much the probability changes from a cell to the next along
// the wall, the mean over the cells from 0.15 to 0.75 m before it (towards y = 0), x from from_m to to_m. 0:
// even.
double Stripes(const Occupancy& map, double wall_m, double from_m, double to_m);

// Over several halls.
struct HallScores {
  int maps = 0, doors_right = 0;
  double false_occupied = 0, missed = 0, missed_free = 0, due = 0;  // sums over maps
  double stripes = 0;

  void Add(const LayerScore& layer, double stripes_here);
  double MissedShare() const { return due > 0 ? missed / due : 0; }
  double MissedFreeShare() const { return due > 0 ? missed_free / due : 0; }
};

}  // namespace cairn::datasets
