// An occupancy grid as it is scored: what each cell is, and how sure that is.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "schema/blob.h"
#include "schema/geometry.h"
#include "schema/kinds/grid_map.h"

namespace cairn::datasets {

struct Occupancy {
  GridBox box;
  std::vector<double> probability;  // of each cell being occupied; NaN: nothing is known of it

  bool IsOccupied(std::int64_t column, std::int64_t row) const {
    return box.Holds(column, row) && probability[box.Index(column, row)] > 0.5;
  }
  bool IsFree(std::int64_t column, std::int64_t row) const {
    return box.Holds(column, row) && probability[box.Index(column, row)] < 0.5;
  }
};

// A difference of log-likelihoods nearer to 0 than this says nothing of a cell.
inline constexpr double kSaysNothingNats = 0.01;

// Of each cell what a grid says of its being occupied; NaN: nothing, as its probability is NaN or
// `log_odds_difference` is there and says nothing.
std::vector<double> KnownProbabilities(const kinds::GridMap::Grid& grid);

// `map/grid/probability` of a grid_map, or its most likely map, `map/grid/occupied`, as 0 and 1; NaN as
// above.
// Throws InputError that names the array: missing, of another shape, a probability beyond [0, 1].
Occupancy ReadOccupancy(const Blob& map);
Occupancy ReadMostLikely(const Blob& map);
bool HasMostLikely(const Blob& map);

}  // namespace cairn::datasets
