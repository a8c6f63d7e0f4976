// Grid maps drawn in letters, for tests.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "schema/blob.h"

namespace cairn::datasets {

// A grid_map of `cell_m` whose lower left corner is (x0_m, y0_m); the first row is the highest. '#' occupied
// (0.9), '.' free (0.1), anything else unknown.
inline Blob DrawnMap(const std::vector<std::string>& rows, double cell_m = 1, double x0_m = 0,
                     double y0_m = 0) {
  std::vector<double> probability;
  for (auto row = rows.rbegin(); row != rows.rend(); ++row) {
    for (const char letter : *row)
      probability.push_back(letter == '#'   ? 0.9
                            : letter == '.' ? 0.1
                                            : std::numeric_limits<double>::quiet_NaN());
  }
  Blob map;
  map.Put("map/grid/probability", Array::Of<double>({static_cast<std::int64_t>(rows.size()),
                                                     static_cast<std::int64_t>(rows[0].size())},
                                                    probability));
  map.PutScalar("map/grid/origin_x_m", x0_m);
  map.PutScalar("map/grid/origin_y_m", y0_m);
  map.PutScalar("map/grid/cell_m", cell_m);
  return map;
}

}  // namespace cairn::datasets
