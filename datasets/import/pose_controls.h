// Controls from poses: what odometry says where a log has its poses and not its steps.
#pragma once

#include <vector>

#include "datasets/import/log_rows.h"
#include "schema/geometry.h"

namespace cairn::datasets {

struct TimedPose {
  double time_s = 0;
  Pose pose;
};

// How far, in position, dead reckoning by the controls may lie from a pose, in metres; headings have no
// error.
inline constexpr double kMostAsideM = 0.005;

// Controls that lead from pose to pose (in the order of time), relative to the first; they begin the log with
// an empty one. From one pose to the next a robot turns half, goes, turns the other half, which is an arc;
// where that ends too far aside it turns towards the next pose, goes straight, and turns again. Forward and
// backward are told by which needs the smaller turn. What lies aside is not forgotten but made good later. A
// robot that stands still gets no row, but for the end of the halt.
Odometry ControlsOf(const std::vector<TimedPose>& poses);

// Of such poses; the controls lie in the folder of their times.
Odometry ControlsOf(const Poses& poses);

}  // namespace cairn::datasets
