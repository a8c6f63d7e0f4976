// What `cairn-reproduce occupancy` runs: the logs and the job behind the figures of [Thr01], on simulated
// data and on a log of the user's.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "schema/blob.h"
#include "schema/job.pb.h"

namespace cairn::datasets {

// evidence_map's inverse model of a sonar. Of p_occupied and p_free only the ratio of their log-odds decides
// what is above a half.
struct InverseSonar {
  double p_occupied = 0.6, p_free = 0.45;
  bool graded = true;
  double wall_m = 0.1;
};
// The settings whose walls and doors are compared (`--study curve`).
std::vector<InverseSonar> InverseSonars();
// The best of them by that study on hallways of seeds 1 to 5: most doors right, then fewest cells wrong.
InverseSonar ChosenInverseSonar();

// One hallway: a log, and the maps of it: name + "_evidence" with the setting chosen, name + "_default" with
// evidence_map's own, name + "_forward".
struct HallCase {
  std::string name;
  int door_readings = 1;
  bool closed = false;
  std::uint64_t seed = 1;
};

struct OccupancyStudy {
  std::map<std::string, Blob> inputs;  // logs, with truth where they are simulated
  proto::Job job;                      // its inputs by these names
  std::vector<HallCase> halls;
};

// "crossing" (figure 1, two readings made by hand), the hallways of `seeds` seeds from `seed` on (figure 3),
// "doors" and "smooth" of the first seed (figures 4 and 5; maps "…_heldout" too, and "smooth_setting_N" for
// each of InverseSonars), "loop" ("loop_landmarks", and by its poses "loop_evidence" and "loop_forward";
// "loop_raw" by odometry), and "log" where `log` is not null ("log_evidence" and so on, held out).
OccupancyStudy MakeOccupancyStudy(std::uint64_t seed, int seeds, const Blob* log);

// The hallways alone, with all of InverseSonars: name + "_setting_N".
OccupancyStudy MakeCurveStudy(std::uint64_t seed, int seeds);

}  // namespace cairn::datasets
