// The joint least squares of a log whose observations name no landmark, and the associations that it bears
// out, in turn.
#pragma once

#include <vector>

#include "pipelines/landmark_map/refinement/joint_refinement.h"

namespace cairn::landmark_map {

// RefineJointly from what EM says of the rows that it used; then all rows are told apart anew from the path
// that this finds, landmarks that turn out to be one are joined, and the least squares is made again, twice
// at most. `landmarks` (EM's, of which the ones that are joined go) and `rows` are those of the last one.
JointRefinement RefineWithAllRows(const kinds::Log& log, const std::vector<AssociatedPath>& paths,
                                  const Settings& settings, std::vector<Landmark>* landmarks,
                                  std::vector<RowAssociations>* rows);

}  // namespace cairn::landmark_map
