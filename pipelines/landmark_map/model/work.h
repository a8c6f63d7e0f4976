// How much work there is, reckoned from sizes alone, never from clocks: so slices are the same everywhere.
//
// The unit is a cell: of the boxes of the moved beliefs, over the steps. A step costs kStepCells more,
// whatever its size. On one core of a 2020s server a backward task does some 10 to 30 million cells a second
// (tests/bench/task_times prints it).
#pragma once

#include <vector>

#include "pipelines/landmark_map/model/e_step.h"

namespace cairn::landmark_map {

inline constexpr double kMostWork = 1e18;  // cells, of a robot's E-step: none takes so long

// The beliefs at each of the first `count` steps where nothing is known but odometry, from a Dirac at the
// start. The pose's covariance is carried along the motion increments to first order; a heading's box is what
// pruning leaves of a Gaussian. Right to a factor of about two while headings are known to a radian.
struct OpenLoop {
  std::vector<double> cells;  // [count]
  std::vector<Box> boxes;     // [S] that hold them; of the steps that follow: where odometry is
};
OpenLoop ReckonOpenLoop(const RobotSteps& steps, const EStepModel& model, int count);

// The work of the first `count` steps.
double WorkOf(const std::vector<double>& cells, int count);

// Cells of a step's belief, the mean over the steps, in a map that says exactly where the robot is whenever
// it observes something.
double MeanCellsInAMap(const RobotSteps& steps, const EStepModel& model);

// The step at which odometry may first have brought the robot back to where it observed something before:
// where that lies in the belief, after it did not. steps.size() where it never does.
int FirstReturn(const RobotSteps& steps, const OpenLoop& loop, const EStepModel& model);

// What a step takes once there is a map, which is not yet sharp: in simulated worlds its belief has kBlur
// times as many cells.
inline constexpr double kBlur = 12.0;
double WorkOfStep(const RobotSteps& steps, const EStepModel& model);

// The work of the first `count` steps in a map of the landmarks that were seen before step `known`: in the
// way that EM adds, those that are seen there for the first time tell nothing yet. A step takes `least`
// (WorkOfStep).
double WorkInAMapUpTo(int known, int count, double least, const RobotSteps& steps, const EStepModel& model);

// How many steps' worth of the whole map a robot that may start anywhere moves until it has found itself: 3
// to 9 in simulated loops of all difficulties.
inline constexpr double kStepsLost = 6.0;

// The work of the first E-step of a robot that may start anywhere: the map's box under every heading
// kStepsLost times.
double WorkWhereLost(int count, const EStepModel& model);

// Nanoseconds that a cell takes over forward and backward pass, on one core of a 2020s server: by the taps of
// the motion increments' kernels and the observations of a step. `in_cache`: the tables of a sharp map; those
// of the first round are larger than caches are.
double CellNanoseconds(const RobotSteps& steps, const EStepModel& model, bool in_cache);

// Cells under each heading from which a robot that may start anywhere may come to see what it observes first,
// in a map whose likelihood table of that is an edge of `table_cells`.
double CellsWhereLost(const RobotSteps& steps, const EStepModel& model, double table_cells);

// How many time slices to provide for `work` in slices of `slice_work`: one where it fits, else more than
// should be needed, for where a slice ends is seen only when it is run; what is not needed is left empty.
int SlicesFor(double work, double slice_work, int count);

}  // namespace cairn::landmark_map
