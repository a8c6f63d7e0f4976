// A motion that odometry knows nothing of: wheels that slipped, a robot that was carried, rows that are not
// there.
#pragma once

#include <cstddef>
#include <vector>

#include "pipelines/landmark_map/refinement/least_squares.h"

namespace cairn::landmark_map {

struct BrokenMotion {
  std::size_t robot = 0, edge = 0;
  double gain_nats = 0.0;  // by which the cost falls without it, where it is quadratic
};

// Those of the largest gains, so many, the first one first; descends from `start` with motions that are a
// little looser, for of one that is as stiff as that of a robot that stands the gain has no digits.
std::vector<BrokenMotion> FindBrokenMotions(LeastSquaresProblem problem, const LeastSquaresPoint& start,
                                            std::size_t most);

// The cost with what widths are worth: minus the logarithm of the density of all errors, up to a constant
// that is the same for the same sightings [nats].
double NegativeLogDensity(const LeastSquaresProblem& problem, const LeastSquaresPoint& point);

}  // namespace cairn::landmark_map
