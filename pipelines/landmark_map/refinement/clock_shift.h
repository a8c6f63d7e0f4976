// Whether a robot's observations have another clock than its odometry: then each was made where the robot was
// a little earlier or later, and where it turns that shows.
#pragma once

#include <span>
#include <vector>

#include "pipelines/common/odometry.h"
#include "pipelines/landmark_map/refinement/least_squares.h"

namespace cairn::landmark_map {

struct ClockShift {
  double late_s = 0.0;  // so much too late are its observations' times, by its odometry's; 0: none is found
  double gain_nats = 0.0;  // that the least squares explains more with it
};

// Of each robot, looked for around `point`, where the least squares ended, and to no more than ten seconds;
// of a large log in its first part. `odometry`: of each robot, of which the problem's tracks are.
std::vector<ClockShift> FindClockShifts(const LeastSquaresProblem& problem, const LeastSquaresPoint& point,
                                        std::span<const Odometry> odometry);

}  // namespace cairn::landmark_map
