// Who else is in an office: those who walk along the corridor, some of whom stop to look at the robot, and
// those who stand in its way.
#pragma once

#include <vector>

#include "datasets/simulate/office/tour.h"

namespace cairn::datasets::office {

struct TimedPoint {
  double time_s = 0;
  Point at;
};
// From one of these to the next, straight on; before the first and after the last they are not there.
using Walk = std::vector<TimedPoint>;

// Nobody whose way leads into the robot.
std::vector<Walk> DrawWalks(const Office& office, const Tour& tour, Rng& rng);

// Where they all are.
std::vector<Point> PersonsAt(const std::vector<Walk>& walks, double time_s);

}  // namespace cairn::datasets::office
