// How a round ends: what its tasks found goes into the weights, and the next round begins.
#pragma once

#include "pipelines/landmark_learning/data/training_data.h"
#include "pipelines/landmark_learning/state/state.h"
#include "pipelines/pipeline.h"

namespace cairn::landmark_learning {

// The next round, or the result. `on_trial`: this is one of several starts, and does not end; once it has
// made as many steps as they are compared after, its State has what it reached as the scalar kTrialScore.
inline constexpr const char* kTrialScore = "trial_score";
Step AdvanceRound(const Options& options, std::uint64_t seed, const State& state, Partials& partials,
                  const Inputs& inputs, bool on_trial = false);

}  // namespace cairn::landmark_learning
