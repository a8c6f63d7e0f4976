// What comes after a round, from its partials and the State.
#pragma once

#include "pipelines/forward_map/options.h"
#include "pipelines/pipeline.h"

namespace cairn::forward_map {

// Of all phases but kCertainty, after which comes the result (result.h).
Step AdvanceSearch(const Options& options, const State& state, Partials& partials, const Inputs& inputs);

}  // namespace cairn::forward_map
