// What follows a round of local_map, and the tasks that match pairs.
#pragma once

#include "pipelines/local_map/options.h"
#include "pipelines/pipeline.h"

namespace cairn::local_map {

// Phases: twice how walls lie; traces; several times pairs, each followed by the optimization of the pose
// graph; the result.
Step AdvanceLocalMap(const Options& options, const State& state, Partials& partials, const Inputs& inputs);

// Inputs: `traces`, rows of `surroundings` and of `pairs`. [pairs] z_m, u_m, sd_z_m, sd_u_m, confidence, ...
Blob MatchPairs(const Inputs& inputs, const Options& options, Progress& progress);

}  // namespace cairn::local_map
