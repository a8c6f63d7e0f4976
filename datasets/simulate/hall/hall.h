// Sonar logs of halls with doors: the simulated and the real worlds of [Thr01] figures 3 to 5. A ring of 24
// sonars (simulate/sonar.h), the robot's poses as the log's own, odometry beside them.
#pragma once

#include <cstdint>

#include "schema/blob.h"

namespace cairn::datasets {

struct SimulateHallwayOptions {
  int door_readings = 3;  // that get through the door, exactly; 1 to 24
  bool closed = false;    // the same hall and drive, its door closed
  std::uint64_t seed = 1;
};

// Figure 3: 1,800 readings along a hall with one door. The door is as wide as it takes for `door_readings`
// cones to be clear of its posts; all others that point at it are bounced off them.
// Throws InputError for what is out of range.
Blob SimulateHallway(const SimulateHallwayOptions& options);

// Figure 4: two narrow doors, and somebody who walks past the robot.
Blob SimulateNarrowDoors(std::uint64_t seed);

// Figure 5: a corridor of 50 m, its lower wall so smooth that it throws sound on like a mirror, open doors in
// the upper one, a person walking behind the robot.
Blob SimulateSmoothWall(std::uint64_t seed);

}  // namespace cairn::datasets
