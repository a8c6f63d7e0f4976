// Beams of range sensors that always say the same, wherever the robot is: a sensor that is broken, or that
// sees the robot itself. Each is a wall beside the robot's whole way.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "schema/blob.h"
#include "schema/walked.h"

namespace cairn::datasets {

struct StuckBeam {
  std::size_t beam = 0;
  double range_m = 0;  // about
};

// The beams that say about one range, to a centimetre, in nearly all scans, where most of the others do not:
// these tell that the robot moved. `range_m`: a row of `beams` for each scan; what is no echo (IsEcho) says
// nothing.
std::vector<StuckBeam> FindStuckBeams(const Walked<double>& range_m, std::size_t beams, double reach_m);

// A warning a sensor that has some. Forgives what is missing.
std::vector<std::string> StuckBeamsOf(const Blob& log);

}  // namespace cairn::datasets
