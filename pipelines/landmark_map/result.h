// The stage's result (schema/FORMAT.md, landmark_map) from the last E-step's summaries.
#pragma once

#include <vector>

#include "pipelines/landmark_map/refined_map.h"
#include "pipelines/landmark_map/state/partial.h"
#include "pipelines/landmark_map/state/schedule.h"
#include "pipelines/pipeline.h"

namespace cairn::landmark_map {

// The group history/: a row an iteration, and the landmarks of the map that each made.
Blob EmptyHistory();
Blob Extended(const Blob& history, const Schedule& done, const RoundSum& sum,
              const std::vector<Landmark>& landmarks);

// The step that ends the stage. Inputs: the state's blob counts, and where EM made no iteration the stage's
// map.
Step MakeResult(const Blob& log, const Settings& settings, const Inputs& inputs, const RoundSum& sum,
                const std::vector<OdometryFit>& odometry, const Blob& history, RefinedMap map);

}  // namespace cairn::landmark_map
