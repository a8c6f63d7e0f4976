// A straight hall along x with rooms behind doors, as in [Thr01] figures 3 to 5.
#pragma once

#include <vector>

#include "datasets/common/walls.h"
#include "datasets/simulate/echo.h"
#include "schema/blob.h"
#include "schema/geometry.h"

namespace cairn::datasets {

struct DoorPlan {
  double centre_x_m = 0, width_m = 0.9;
  double room_depth_m = 2, room_half_width_m = 1.5;  // of the room behind it
  bool open = true;
};

// The hall's walls are at y = -below_m and y = above_m; doors are in the upper one, in order of x, their
// rooms apart.
struct HallPlan {
  double from_x_m = 0, to_x_m = 10;
  double below_m = 1, above_m = 1;
  bool smooth_below = false;  // a mirror for sound
  std::vector<DoorPlan> doors;
};

struct Hall {
  std::vector<Wall> rough;   // of the hall itself, with the leaves of closed doors
  std::vector<Wall> smooth;  // of the hall itself; nothing lies behind them
  std::vector<Wall> rooms;   // what can be seen through open doors only
  std::vector<Wall> doors;   // their openings
  std::vector<bool> open;    // each door
};

Hall BuildHall(const HallPlan& plan);

// What sonars hear of it.
std::vector<Obstacle> ObstaclesOf(const Hall& hall);

// truth/walls/… and truth/doors/…
void PutHall(const Hall& hall, Blob& log);

}  // namespace cairn::datasets
