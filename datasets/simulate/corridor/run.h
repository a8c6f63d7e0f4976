// One drive through the corridor, and all that differs from run to run ([Thr98] sections 5.1.1, 5.1.2).
#pragma once

#include <array>
#include <vector>

#include "datasets/simulate/corridor/world.h"
#include "schema/geometry.h"

namespace cairn::datasets::corridor {

inline constexpr double kSpeedMps = 0.15;

// Walks, or stands, at `y_m` all the time.
struct Person {
  double x_m = 0;  // at time 0
  double speed_mps = 0;
  double y_m = 0, height_m = 1.7;
  Rgb shirt, trousers, skin;
};

struct Snapshot {
  double time_s = 0;
  Pose pose;
};

struct Run {
  std::array<std::vector<bool>, 2> open;  // by Side: of each opening; a door that is open
  std::vector<bool> lamp_on;
  std::vector<Bin> bins;  // as they stand that day
  std::vector<Person> people;
  double brightness = 1, daylight = 0, noise = 0.02;  // noise: of a pixel, sd, of 1
  Rgb white{1, 1, 1};                                 // balance of the camera
  std::vector<Snapshot> snapshots;
};

// Snapshots are taken at even times, over the whole length. `snapshots`: at least 2. `back`: it comes from
// the far end.
Run DrawRun(const World& world, int snapshots, bool back, Rng& rng);

}  // namespace cairn::datasets::corridor
