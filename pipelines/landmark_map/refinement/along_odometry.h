// The map that odometry alone would lay out, for logs on which the search finds none that explains them.
#pragma once

#include <optional>
#include <vector>

#include "pipelines/landmark_map/refinement/fitted_map.h"

namespace cairn::landmark_map {

// Landmarks from whole images along odometry as it is, and the least squares from there: what the robot came
// back to is met again where odometry has not drifted further than the gate, and is there twice elsewhere.
// `steps`: of each robot, with their drift. Its `refined.refused` says where it has no solution.
FittedMap LaidAlongOdometry(const kinds::Log& log, const std::vector<RobotSteps>& steps,
                            const Settings& settings);

// By how many nats the map is behind the one along odometry: each costs its least squares, its rows of no
// landmark, and as much for each landmark, of which the first row explains nothing. Infinite where the map
// was refused and the other was not; none where the other was.
std::optional<double> BehindOdometry(const FittedMap& map, const FittedMap& along);

// What takes the place of a search's map, of landmarks without names, that explains little: it was refused
// because odometry would be wrong by half, or a fifth of the rows is of none of its landmarks. The map along
// odometry where that is ten nats ahead; where both were refused nothing but odometry, without a landmark.
std::optional<FittedMap> BetterAlongOdometry(const FittedMap& of_search, const kinds::Log& log,
                                             const std::vector<RobotSteps>& steps, const Settings& settings);

}  // namespace cairn::landmark_map
