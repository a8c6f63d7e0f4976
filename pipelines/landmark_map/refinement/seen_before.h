// Landmarks with names that robots saw only before they saw one that the first robot knows, too: EM's steps
// of a robot begin there.
#pragma once

#include <vector>

#include "pipelines/landmark_map/landmarks/summary.h"
#include "pipelines/landmark_map/refinement/refine.h"
#include "schema/kinds/log.h"

namespace cairn::landmark_map {

// Adds them to `landmarks`, in the order of their names' numbers, each where the last row of it says, by
// odometry back from the robot's first step; `associated` keeps up with their numbers. The covariance is that
// of a heading which odometry loses on the way back. Those that the first robot saw, or that are in the map,
// stay as they are; rows after `until_s` say nothing.
void AddSeenBefore(const kinds::Log& log, const std::vector<AssociatedPath>& paths, double until_s,
                   std::vector<Landmark>* landmarks, std::vector<Associated>* associated);

}  // namespace cairn::landmark_map
