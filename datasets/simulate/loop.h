// Synthetic logs of robots that drive through corridors round a large cycle, press a button at each place
// worth marking, and have poor odometry: the problem of [TBF98].
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "datasets/simulate/odometry.h"
#include "datasets/simulate/sensing.h"
#include "schema/blob.h"

namespace cairn::datasets {

struct LoopDifficulty {
  std::string name;
  double min_path_m = 1000;
  double step_m = 0.33;  // distance of one control
  int min_contacts = 0;  // of one robot
  int max_contacts = 1000000;
  double box_m = 90;
  OdometryNoise noise;
  ErrorRange final_error;
};

// paper, base, hard, extreme, museum.
const std::vector<LoopDifficulty>& LoopDifficulties();
// Throws InputError for an unknown one.
const LoopDifficulty& LoopDifficultyOf(const std::string& name);

struct SimulateLoopOptions {
  std::string difficulty = "base";
  int robots = 1;  // at least 1, at most 64; each starts anywhere and errs in its own way
  std::uint64_t seed = 1;
  LoopSensing sensing = {};
  bool sonar = false;  // also a ring of sonars, and the walls in the truth
};

// A `log` with its truth (schema/FORMAT.md). Robot N's rows do not depend on how many robots there are, nor
// drives and odometry on what is sensed. The nominal noise parameters are the simulator's own, each times a
// factor drawn from [1/1.5, 1.5] on a log scale and rounded to one digit where that stays within half the
// value: what a data sheet would say. Rates of false and missed observations are stated where either is asked
// for.
// Throws InputError for an unknown difficulty, and what is out of range.
Blob SimulateLoop(const SimulateLoopOptions& options);

// Distance between where the odometry of robot `robot` of a log ends and where it truly ended, both from the
// true start.
// Throws InputError where the log has no such robot or no true poses of it.
double FinalOdometricErrorM(const Blob& log, int robot);

}  // namespace cairn::datasets
