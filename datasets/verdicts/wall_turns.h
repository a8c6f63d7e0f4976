// Whether a local_map's walls stand at right angles, as its headings suppose: its path turns otherwise than
// odometry where they do not.
#pragma once

#include <cstddef>

#include "schema/kinds/local_map.h"

namespace cairn::datasets {

// Of how a robot's headings turn against odometry's from each half metre to that two metres on, less a drift
// that is the same all along.
struct WallTurns {
  double path_m = 0;      // 0: no walls were seen
  double drift_rad = 0;   // the drift that was taken off, over the whole path
  double turn_scale = 0;  // what odometry would make too much of its turns; 0 where the path hardly has any
  // Turns less that share of odometry's and their median: root mean square, and what most are within (1.48
  // medians).
  double rms_rad = 0, sd_rad = 0;
  // Where turns, none taken off for odometry's scale, stand out from the rest, counted at each pass; half of
  // them are off by more than this.
  std::size_t places = 0;
  double place_rad = 0;
  // Pairs of two passes of one place in one direction or the other; how alike both turn against odometry
  // there: their correlation, and its root in radians.
  std::size_t pairs = 0;
  double alike = 0, alike_rad = 0;
  double other_share = 0;  // of scans that see other edges rather than walls
};
WallTurns FindWallTurns(const kinds::LocalMap::Robot& robot);

}  // namespace cairn::datasets
