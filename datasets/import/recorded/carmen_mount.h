// Where a laser sits on its robot, and where its beams point: what CARMEN's messages tell, and what they
// leave open.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "schema/geometry.h"

namespace cairn::datasets {

// The robot's pose where its laser, mounted so, is at `laser`.
Pose RobotUnder(const Pose& laser, const Pose& mount);

// The median of each coordinate (heading: about the first one). `mounts` is not empty.
Pose MedianMount(const std::vector<Pose>& mounts);

// Whether they differ more than rounding can (5 cm or 2 degrees off their median): the laser's poses were
// mended and the robot's were not, as a laser does not move on its robot.
bool MovesApart(const std::vector<Pose>& mounts);

// Whether laser and robot have the same pose throughout: the log does not tell them apart.
bool AllAlike(const std::vector<Pose>& mounts);

// Beams from right to left, in the laser's frame.
struct BeamFan {
  double first_deg = 0, step_deg = 0;
  bool guessed = false;  // nothing says how wide they stand
};
// As given, else by the step that PARAM states, else by the number of beams: 1 and 0.5 degrees for 180, 181
// and 360, 361, 0.25 for 400 and 401 (about the middle), else 180 degrees in all.
BeamFan FanOf(std::size_t beams, std::optional<double> first_deg, std::optional<double> step_deg,
              std::optional<double> param_step_deg);

}  // namespace cairn::datasets
