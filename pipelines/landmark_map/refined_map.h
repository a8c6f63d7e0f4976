// What the last E-step's summaries come to: landmarks, what each observation is of, and, where landmarks are
// seen at a distance, the joint least squares.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipelines/landmark_map/refinement/moved_landmarks.h"
#include "pipelines/landmark_map/refinement/shifted.h"
#include "pipelines/landmark_map/state/partial.h"
#include "pipelines/landmark_map/state/settings.h"
#include "pipelines/pipeline.h"

namespace cairn::landmark_map {

struct RefinedMap {
  std::vector<RobotSteps> steps;
  std::vector<Landmark> landmarks;
  std::vector<Landmark> found;        // the same, where EM left them
  std::vector<RowAssociations> rows;  // of each robot
  // Of all landmarks together [2K,2K], x and y of each; empty: not known, or they are too many.
  Eigen::MatrixXd covariance;
  JointRefinement refined;
  // Of each robot, where all observations are contact detections and the landmarks were refined.
  std::vector<RefinedPath> contact_paths;
  std::vector<MovedLandmark> moved;
  std::optional<WeighedShift> shift;
  bool along_odometry = false;  // the search's own map explained less
  std::string not_refined;      // why the landmarks are not those of the least squares; empty: they are
};

// The State's.
LayeredGrid CountsIn(const Inputs& inputs, const Settings& settings);
// A given map that no iteration has touched.
bool IsGivenMap(const Inputs& inputs, const LayeredGrid& counts);

// Inputs: the state's blobs landmarks, counts, steps/N. `not_refined`: as RefinedMap has it, but where it is
// empty the landmarks are those of the least squares, or, `jointly`, are to be, and so are all paths. Throws
// InputError where a landmark stays `in_two_places`.
RefinedMap RefineMapOf(const Blob& log, const Settings& settings, const Inputs& inputs, const RoundSum& sum,
                       const std::vector<OdometryFit>& odometry, std::string not_refined, bool jointly,
                       const std::vector<InTwoPlaces>& in_two_places);

// All landmarks where a robot is moved to the place in which they agree by far better (robot_ties.h); none
// where there is no such robot.
std::optional<std::vector<Landmark>> PlacedAnew(const Blob& log, const RefinedMap& map,
                                                const Settings& settings);

}  // namespace cairn::landmark_map
