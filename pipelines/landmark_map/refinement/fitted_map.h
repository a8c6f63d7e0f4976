// A map of the joint least squares with what it was made from, and how two of one log compare.
#pragma once

#include <vector>

#include "pipelines/landmark_map/refinement/joint_refinement.h"

namespace cairn::landmark_map {

struct FittedMap {
  std::vector<AssociatedPath> paths;
  std::vector<Landmark> landmarks;    // where the least squares found them
  std::vector<RowAssociations> rows;  // of each robot
  JointRefinement refined;
};

// What a row costs that is of no landmark, as row_associations.cc has it.
inline constexpr double kOfNoLandmark_nats = 8;

std::int64_t RowsOfNone(const std::vector<RowAssociations>& rows);

// What the least squares of a map costs [nats] under the wider of its own widths and the other's, of each
// kind, and the heavier tails: what one map needs the other may have, too.
double CostBeside(const JointRefinement& map, const JointRefinement& other);

}  // namespace cairn::landmark_map
