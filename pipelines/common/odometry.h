// Dead reckoning: the path that a robot's controls alone give, starting at (0, 0) with heading 0.
#pragma once

#include <string>
#include <vector>

#include "schema/kinds/log.h"

namespace cairn {

struct Odometry {                             // one entry a control, plus one for the start
  std::vector<double> time_s;                 // [C + 1]
  std::vector<double> x_m, y_m, heading_rad;  // heading is not wrapped
  std::vector<double> path_m, turn_rad;       // distance travelled and sum of absolute turns so far
  std::vector<double> aside_rad;              // direction of the way to here, from the heading
};

// Of one moment's motion that turns from a heading to that of its way and from there to another: has it gone
// aside, or turned back? A robot that cannot go aside may swing a little to either side between two poses.
bool GoesAside(double from_rad, double way_rad, double to_rad);

// Without the controls after the one that is under way, or ends, at `until_s`.
Odometry Until(Odometry odometry, double until_s);

// A pose on that path.
struct OdometricPose {
  double time_s, x_m, y_m, heading_rad, path_m, turn_rad;
};

// Integrates turn_rad, then forward_m, of a log that was checked as its kind. A control that is followed
// at the same time by a turn back has gone aside: so a log tells of a robot that can. It has turned by what
// is left, half before its way and half after it. Throws InputError that names robot and row where
// - there are no controls;
// - a distance is beyond 100 km or a turn beyond 1000 rad.
Odometry Integrate(const kinds::Log::Odometry& controls, const std::string& name);

// The pose at `time_s`: after all controls that have ended by then, and after the turn and a part of the way
// of the one under way; ends are clamped.
OdometricPose PoseAt(const Odometry& odometry, double time_s);

// The pose where `path_m` has been travelled, at the earliest.
OdometricPose PoseAtPath(const Odometry& odometry, double path_m);

// The pose at the end of control `i` - 1 (0: the start).
OdometricPose PoseOf(const Odometry& odometry, std::size_t i);

}  // namespace cairn
