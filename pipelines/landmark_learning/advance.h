// How a round ends: what its tasks found goes into the weights, and the next round begins.
#pragma once

#include "pipelines/landmark_learning/training.h"
#include "pipelines/landmark_learning/training_data.h"
#include "pipelines/pipeline.h"

namespace cairn::landmark_learning {

// The next round, or the result.
Step AdvanceRound(const Options& options, std::uint64_t seed, const State& state, Partials& partials,
                  const Inputs& inputs);

}  // namespace cairn::landmark_learning
