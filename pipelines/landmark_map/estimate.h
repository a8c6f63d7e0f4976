// What a job will cost, reckoned from sizes before any of it is allocated: for people who ask, and to refuse
// what their machines cannot hold.
#pragma once

#include <string>
#include <vector>

#include "pipelines/landmark_map/model/steps.h"
#include "pipelines/landmark_map/round.h"
#include "pipelines/landmark_map/state/schedule.h"

namespace cairn::landmark_map {

// 1 MB = 10^6 bytes. How right these are: EXPERIMENTS.md.
struct Estimate {
  double cells = 0;      // that the first round moves
  double tasks = 0;      // of the first round
  double rounds = 0;     // some; a search may go on for longer
  double seconds = 0;    // of one core, the whole job
  double task_mb = 0;    // tables of the largest task: alphas, beta, counts; or of the M-step
  double memory_mb = 0;  // of a worker: that task, the blobs that it keeps, the program itself
  double store_mb = 0;   // partials and States of a round and of the one before

  // Into the State's scalars, as expected/cells and so on, where --dry-run reads them.
  void Store(State* state) const;
};

// A grid's settings, and each robot's steps on it.
struct OnGrid {
  const Settings& settings;
  const std::vector<RobotSteps>& robots;
};

// `search`: the grid on which the first robot's map is found; `last`: the one on which EM ends; `starts`: the
// first round of each candidate; `given`: of the map that EM starts from, if any.
Estimate EstimateJob(const Options& options, const OnGrid& search, const OnGrid& last,
                     const std::vector<cairn::Step>& starts, const Perception* given = nullptr);

// For people, one line.
std::string Sentence(const Estimate& estimate, const Settings& settings, const RobotStates& robot_states);

// Of the M-step's tables: counts, a partial's, the map, its sums over the perceptual radius, the likelihood.
inline constexpr double kMStepTables = 9.0;
double MStepBytes(const LayeredGrid& counts, const MapRules& rules);

}  // namespace cairn::landmark_map
