// Samples of a robot with a camera and 24 sonars that drives through an office corridor, as in [Thr98]
// section 5.1.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "schema/blob.h"

namespace cairn::datasets {

// "d1": the camera points at the outer wall; "d2": at the inner wall; "d3": at the ceiling.
const std::vector<std::string>& CorridorSets();

struct SimulateCorridorOptions {
  std::string set = "d1";
  int runs = 4;                // 1 to 64
  int snapshots = 808;         // of a run, at even times; 2 to 100,000
  double length_m = 89;        // 30 to 1,000
  double label_error_m = 0.1;  // of x_m, and of y_m: standard deviation, 0 to 5
  std::uint64_t seed = 1;
  bool images = false;     // the images instead of their features
  bool odometry = false;   // what odometry makes of the way from each snapshot to the next
  bool both_ways = false;  // every other run comes back from the far end, the camera on the robot's same side
  double changed = 0;      // share of what hangs, stands or is painted that was changed since: 0 to 1
};

// Of the run of this number, from 0 on: "d1 run 1".
std::string CorridorRunName(const SimulateCorridorOptions& options, int number);

// A PNG of images along a run.
struct CorridorPicture {
  std::string name, png;
};

// Kind `samples` (schema/FORMAT.md): 140 image features ([Thr98] section 5.1.3) and 24 sonars; two hand-made
// features, what is truly in view ("door" or "light") and what a detector says ("door detected" …); true
// poses. The corridor depends on seed and length alone, so that the sets of a seed are of one corridor; a run
// on those, on the set, its number and whether anything has changed. `pictures`, where it is not null, gets
// one for each run: an image a metre.
// Throws InputError for what is out of range.
Blob SimulateCorridor(const SimulateCorridorOptions& options,
                      std::vector<CorridorPicture>* pictures = nullptr);

}  // namespace cairn::datasets
