// The stage's result (schema/FORMAT.md, landmark_map) from the last E-step's summaries.
#pragma once

#include <string>
#include <vector>

#include "pipelines/landmark_map/refinement/contradictions.h"
#include "pipelines/landmark_map/state/partial.h"
#include "pipelines/landmark_map/state/schedule.h"
#include "pipelines/pipeline.h"

namespace cairn::landmark_map {

// The group history/: a row an iteration.
Blob EmptyHistory();
Blob Extended(const Blob& history, const Schedule& done, const RoundSum& sum);

// The step that ends the stage. Inputs: the state's blobs landmarks, counts, steps/N, and where EM made no
// iteration the stage's map. `not_refined`: why the landmarks are not those of the least squares; empty: they
// are, or, `jointly`, are to be, and so are all paths. Throws InputError where a landmark stays
// `in_two_places`.
Step MakeResult(const Blob& log, const Settings& settings, const Inputs& inputs, const RoundSum& sum,
                const std::vector<OdometryFit>& odometry, const Blob& history, std::string not_refined,
                bool jointly, const std::vector<InTwoPlaces>& in_two_places);

}  // namespace cairn::landmark_map
