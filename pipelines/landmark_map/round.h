// A round of landmark_map: the State that it starts from and its tasks, chains over the time slices of each
// robot.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "pipelines/landmark_map/model/odometry_fit.h"
#include "pipelines/landmark_map/state/schedule.h"
#include "pipelines/pipeline.h"

namespace cairn::landmark_map {

// What the State carries from round to round besides the schedule.
struct RobotStates {
  std::map<std::string, std::string> blobs;  // name -> hash: settings, steps/N
  std::vector<std::int64_t> step_counts;     // per robot
  std::vector<OdometryFit> odometry;         // per robot
  std::vector<double> work;                  // per robot, expected of its next E-step (model/work.h)
  std::vector<double> sharp;                 // per robot, expected of a step once the map is sharp
  std::vector<std::int64_t> overlap;         // per robot: steps by which guesses overlap (speculation.h)
  std::vector<double> refined_rows;          // per robot: of its least squares (outlook.h)
  std::int64_t landmarks = 0;                // of the last M-step's map; 0: there is none yet

  void Store(State* state) const;
  // Throws InputError where a figure is none that Store could have stored: others made the State.
  static RobotStates Load(const State& state, std::size_t robots);
};

// Expected counts as rounds keep them.
Blob StoredCounts(const LayeredGrid& counts);

// How many of a robot's steps an E-step looks at.
int StepsInUse(const Schedule& schedule, std::int64_t steps);

// Whether the tasks `backward` of this E-step leave tables from which the next one's slices may be guessed.
bool LeavesTables(const Options& options, const Schedule& schedule);

// State's scalar, of a round that comes before one in which robots are apart: which task makes the map that
// all but this one make.
std::string TaskWithout(std::size_t robot);
// State blob: the map that a robot is found in, where that is not `perception`.
std::string PerceptionFor(std::size_t robot);

// State blob: where the round before had a robot at its first step (rows of StartBox), near which it starts.
std::string StartNear(std::size_t robot);

// What a task is told of its robot's odometry.
OdometryFit OdometryOf(const Task& task);

// Fills `step` with the E-step that `schedule` asks for. `fresh`: the round's own blobs (history, counts,
// and, once there is a map, perception and landmarks; guesses/N of the robots of which slices are guessed).
// For each robot the tasks `forward` run one after the other, each from where the one before ended until it
// has done a slice's work, so that they cut the time; the tasks `backward` run from the last slice to the
// first, each from alpha at its start and beta at its end. The last slice takes what the others left; where
// they left nothing, tasks are empty. Where slices are guessed, the tasks `guess` run side by side before,
// and the others take what was guessed right.
void PlanRound(const Options& options, const std::vector<std::string>& robots, const Schedule& schedule,
               const RobotStates& robot_states, const std::map<std::string, Blob>& fresh, cairn::Step* step);

// Before PlanRound: the slices of a robot of which some are guessed, from the blob guesses/N.
void GuessSlices(std::size_t robot, const std::vector<bool>& which, State* state);

// Every slice of the round waits for the one before, whatever the State was to guess.
void GuessNothing(State* state);

// The tasks alone, of a State that PlanRound made.
void PlanTasks(const Options& options, const std::vector<std::string>& robots, proto::Step* plan);

}  // namespace cairn::landmark_map
