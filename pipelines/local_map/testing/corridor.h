// Walls for tests of positions: a corridor along x with niches, whose ends are closed.
#pragma once

#include <vector>

#include "pipelines/local_map/testing/room.h"

namespace cairn::local_map {

// From -6 to 6 m, 2.4 m wide; its left side has niches of different widths, its right side cupboards.
inline std::vector<TestWall> NichedCorridor() {
  std::vector<TestWall> walls = TestBox(12, 2.4, {0, 0, 0});
  for (const auto& [x, width] : {std::pair{-4.0, 0.8}, {-1.0, 1.2}, {2.5, 0.6}, {4.5, 1.0}}) {
    for (const TestWall& wall : TestBox(width, 0.4, {x, 1.0, 0})) walls.push_back(wall);
    for (const TestWall& wall : TestBox(width / 2, 0.3, {x + 1.2, -1.05, 0})) walls.push_back(wall);
  }
  return walls;
}

}  // namespace cairn::local_map
