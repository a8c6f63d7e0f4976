// EM of one map, an iteration at a time: what follows an E-step.
#pragma once

#include "pipelines/landmark_map/state/options.h"
#include "pipelines/pipeline.h"

namespace cairn::landmark_map {

// The next E-step under the map that the M-step made; once EM has settled the last one, which also gives
// poses and associations, then the same under the refined map, then the result. Inputs: the stage's, and the
// State's blobs by their names there.
// Throws NoPathError where no path fits, InputError where the data contradict each other.
cairn::Step AdvanceEm(const Options& options, const State& state, Partials& partials, const Inputs& inputs);

}  // namespace cairn::landmark_map
