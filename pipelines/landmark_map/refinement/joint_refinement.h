// The bottom of the basin that EM has found: joint least squares over all that was seen, as exactly as the
// log has it.
#pragma once

#include <string>
#include <vector>

#include "pipelines/landmark_map/landmarks/summary.h"
#include "pipelines/landmark_map/refinement/model_fit.h"
#include "pipelines/landmark_map/refinement/refine.h"
#include "pipelines/landmark_map/refinement/refined_path.h"
#include "pipelines/landmark_map/refinement/row_associations.h"
#include "pipelines/landmark_map/refinement/sensor_shift.h"
#include "schema/kinds/log.h"

namespace cairn::landmark_map {

struct JointRefinement {
  std::string refused;  // why the result stays as EM left it; empty: it is this one
  std::vector<Landmark> landmarks;
  std::vector<RefinedPath> paths;  // of each robot
  ModelFit fit;
  std::vector<SensorShift> sensors;  // of each robot
  // What it is the end of, with the widths that were found.
  LeastSquaresProblem problem = {};
  LeastSquaresPoint point = {};
  // Of all landmarks together [2K,2K], of which theirs are the diagonal blocks; empty: they are too many.
  Eigen::MatrixXd covariance = {};
};

// Unknown are the poses at all observations of landmarks, the landmarks, and each robot's drift and scales
// (of ways only where ranges tell it; elsewhere the covariances count it as uncertain); widths are estimated
// too. An observation is of the landmark that it
// names, or of that which `rows`, of each robot, take it for, if that is likelier than not. It descends from
// EM's path and from odometry's, which is taken up piece by piece, and the better end counts. Not where EM's
// own path explains more.
JointRefinement RefineJointly(const kinds::Log& log, const std::vector<AssociatedPath>& paths,
                              const std::vector<RowAssociations>& rows, const Settings& settings,
                              const std::vector<Landmark>& landmarks);

}  // namespace cairn::landmark_map
