// Landmarks that a robot saw only before, or only after, one moment, though it looked at their places on the
// other side of it as well: where odometry slips and nothing has a name, what is seen after the slip becomes
// landmarks of its own beside those seen before, and everything fits.
#pragma once

#include <cstdint>

#include "pipelines/landmark_map/refinement/least_squares.h"

namespace cairn::landmark_map {

// Of the robot and the moment for which there are most one-sided landmarks beyond twice as many as the
// others; these are 0 where there are nowhere so many.
struct OneSided {
  std::int64_t one_sided = 0, two_sided = 0;  // landmarks, of those that both sides looked at
  double at_s = 0;                            // the last look before the moment
  // The most one-sided ones at any moment, for any robot, whatever the others.
  std::int64_t most = 0;
  double most_at_s = 0;
  std::int64_t Excess() const { return one_sided - 2 * two_sided; }
};

// A one-sided landmark counts where three looks or more show it, and three would on the other side if as many
// of its looks did there: one that the robot comes to late, or that something hides from there, does not. The
// moments are those that have a tenth of the robot's looks on either side.
OneSided FindOneSided(const LeastSquaresProblem& problem, const LeastSquaresPoint& point);

}  // namespace cairn::landmark_map
