// How the robot of [DM98] drives through an office: straight on, parallel to the walls, with turns on the
// spot between; into one room after another, all of them again and again.
#pragma once

#include <vector>

#include "datasets/simulate/drive.h"
#include "datasets/simulate/office/plan.h"

namespace cairn::datasets::office {

inline constexpr double kTickS = 0.2;  // of a control, after which the robot listens

// Somebody stands in the way, and the robot before them.
struct Stop {
  double from_s = 0, to_s = 0;
  Point person;
  double heading_rad = 0;  // the robot's: they come and go along it
};

struct Tour {
  Drive drive;              // a control every kTickS, some of them of standing
  std::vector<Pose> poses;  // at the end of each
  std::vector<Stop> stops;
  std::vector<double> doorways_s;  // when it was in a doorway
  double moved_s = 0;              // when it had waited for the furniture to be moved; 0: it had not
};

// Drives for `minutes`. It begins in the corridor, turned any way. `waits`: after half of the time it stands
// in the corridor for half a minute.
Tour DrawTour(const Office& office, double minutes, bool waits, Rng& rng);

}  // namespace cairn::datasets::office
