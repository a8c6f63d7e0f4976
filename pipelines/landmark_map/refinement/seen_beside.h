// Landmarks with names that EM has none of: those that a later robot saw before it saw one that the first
// robot knows, too, where its steps begin; and those that were seen where the path is so vague that no cell
// holds half an observation of them.
#pragma once

#include <vector>

#include "pipelines/landmark_map/landmarks/summary.h"
#include "pipelines/landmark_map/refinement/refine.h"
#include "schema/kinds/log.h"

namespace cairn::landmark_map {

// Adds them to `landmarks`, in the order of their names' numbers, each where the row of it says that lies
// nearest to a step, by odometry from that step; `associated` keeps up with their numbers, and the rows of
// them are theirs. The covariance is that of a heading which odometry loses on the way. Those that are in the
// map stay as they are; rows after `until_s` say nothing.
void AddSeenBeside(const kinds::Log& log, const std::vector<AssociatedPath>& paths, double until_s,
                   std::vector<Landmark>* landmarks, std::vector<Associated>* associated);

}  // namespace cairn::landmark_map
