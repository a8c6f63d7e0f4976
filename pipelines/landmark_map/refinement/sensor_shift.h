// Whether a robot's observations have another clock than its odometry, or its sensor sits elsewhere than
// where the robot turns about, or is turned against its wheels: where the robot turns, or goes on, that
// shows.
#pragma once

#include <span>
#include <vector>

#include "pipelines/common/odometry.h"
#include "pipelines/landmark_map/refinement/least_squares.h"

namespace cairn::landmark_map {

// 0: nothing of the kind is found. Both a lateness and a place: the one explains as much as the other.
struct SensorShift {
  double late_s = 0.0;          // so much too late are its observations' times, by its odometry's
  double turned_rad = 0.0;      // so much too large are their bearings
  double x_m = 0.0, y_m = 0.0;  // so far ahead and to the left sits its sensor
};

// Of each robot, among the landmarks that it sees, looked for around `point`, where the least squares ended,
// to no more than ten seconds, half a radian and two metres, whichever explains more, with odometry's widths
// that go with it; of a large log in its first part. A place counts only where the observations tell it to a
// tenth of a metre, a lateness from half a row of odometry on.
// `odometry`: of each robot, of which the problem's tracks are; `expected`: its widths.
std::vector<SensorShift> FindSensorShifts(const LeastSquaresProblem& problem, const LeastSquaresPoint& point,
                                          std::span<const Odometry> odometry,
                                          std::span<const EdgeWidths> expected);

}  // namespace cairn::landmark_map
