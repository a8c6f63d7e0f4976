// The last step of a map: least squares over the associations on which the posterior has settled. It knows no
// cells, and bends all paths at once, for which EM takes very many iterations.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipelines/landmark_map/landmarks/summary.h"
#include "pipelines/landmark_map/model/odometry_fit.h"
#include "pipelines/landmark_map/model/steps.h"
#include "pipelines/landmark_map/state/partial.h"
#include "pipelines/landmark_map/state/schedule.h"

namespace cairn::landmark_map {

// What the last E-step says of one robot.
struct AssociatedPath {
  RobotSteps steps;      // without the drift that was found
  OdometryFit odometry;  // drift and widths
  // Mean poses [S]; the correction of the odometric heading.
  std::vector<double> x_m, y_m, correction_rad;
  Associated associated;
};

// `landmarks`: so many there are. Throws InputError where the sum's summaries are not of these steps.
std::vector<AssociatedPath> AssociatedPaths(const RoundSum& sum, const std::vector<RobotSteps>& steps,
                                            const std::vector<OdometryFit>& odometry, std::size_t landmarks);

// What the least squares came to.
struct Refinement {
  std::vector<Landmark> landmarks;
  std::string refused;  // why the map stays as EM left it; empty: the landmarks are its new ones
};

// The landmarks with the positions, and their covariances, of the least squares over all poses, landmarks and
// the robots' drifts: motion increments of odometry as the motion model has them, observations that are
// likelier of their landmark than not, each with a Cauchy weight. The first robot's first pose stays at the
// origin, or, where the gauge is free, where it is. How far landmarks move says nothing: a bent map may turn
// and stretch by many metres. Refused where that has no solution, or one in which observations that lay
// nearest to their landmark lie nearer to another: the associations have not settled. Of range-bearing
// observations also where a landmark would move further than the core: what ranges err by in common would
// stretch the map.
Refinement RefineMap(const std::vector<AssociatedPath>& paths, const Settings& settings,
                     const std::vector<Landmark>& landmarks);

// What EM expects where it knows no more than these landmarks: on any grid.
// Throws InputError where it would need more memory than is allowed.
LayeredGrid CountsFromLandmarks(const std::vector<Landmark>& landmarks, const Settings& settings);

// The expected counts with each landmark's mass where it now stands, as wide as is said, or as its
// covariance. Throws as CountsFromLandmarks.
LayeredGrid Recentred(LayeredGrid counts, const std::vector<Landmark>& before,
                      const std::vector<Landmark>& now, const Settings& settings,
                      std::optional<double> width_m = std::nullopt);

}  // namespace cairn::landmark_map
