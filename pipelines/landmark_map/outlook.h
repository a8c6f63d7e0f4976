// What EM, and the search for its start, have ahead of them: for the time left that people are told.
#pragma once

#include <vector>

#include "pipelines/landmark_map/round.h"
#include "schema/kinds/log.h"

namespace cairn::landmark_map {

// Microseconds of a core a cell (model/work.h): of a forward task, and of a backward one, which goes forward
// first; of an M-step; of a task that adds up partials.
inline constexpr double kForwardUs = 0.004, kBackwardUs = 0.009, kMStepUs = 800.0, kSumUs = 200.0;
// Least squares: over contact detections, a step of all robots; over observations at a distance, a row, and
// as much more for each landmark of the map, with which the rows of the matrix get wider.
inline constexpr double kRefinementUs = 100.0;
inline constexpr double kRefinedRowUs = 55.0, kRefinedRowAndLandmarkUs = 0.06;
// Without a map a cell takes so many times as long.
inline constexpr double kWithoutMap = 2.0;

// How many rows of a robot the least squares goes through: those at a distance, and those without a name once
// more, for it tells anew which is which.
double RefinedRows(const kinds::Log::Observations& seen);

// After the tasks: the rounds of the first robot's EM, then those of all robots and the summaries. Iterations
// are as many as is usual, where so many are allowed.
void ExpectEm(const Options& options, const Schedule& schedule, const RobotStates& robot_states,
              proto::Step* plan);

// What a candidate's State says of the search: in which wave it was proposed; how many starts further out
// were to be tried after that wave if it found the best map no more often; how many times as many cells
// beliefs have on the grid on which the best one goes on, where that is a finer one.
inline constexpr const char *kWave = "wave", *kBeyond = "beyond", *kFiner = "finer";

// What the candidates' steps cost so far and will, as their States say it.
class SearchOutlook {
 public:
  // `steps`: of each candidate, before they are merged.
  SearchOutlook(const Options& options, const std::vector<cairn::Step>& steps);
  // Of their merged round.
  void Announce(proto::Step* plan) const;

 private:
  double rounds_ = 0.0, cost_ = 0.0, width_ = 0.0;  // of those that there are
  double new_rounds_ = 0.0, new_cost_ = 0.0, new_width_ = 0.0, new_least_ = 1.0, new_most_ = 1.0;
  double last_rounds_ = 0.0, last_cost_ = 0.0, refinement_ = 0.0;
};

// Microseconds of a core that the tasks of a candidate's rounds should have taken so far, those that its
// State plans included.
double CostSoFar(const State& state);
// Adds what the step's tasks cost to what `before` says that the candidate has cost.
void CountCost(const State& before, cairn::Step* step);

}  // namespace cairn::landmark_map
