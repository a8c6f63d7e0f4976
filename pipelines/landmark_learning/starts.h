// Several starts train side by side for some steps (common/fan_out.h); the one that is best then goes on.
#pragma once

#include <cstdint>
#include <vector>

#include "pipelines/landmark_learning/state/options.h"
#include "pipelines/pipeline.h"

namespace cairn::landmark_learning {

// Of the errors of a start's steps: the mean of the last few, which noise and mini-batches blur; or the least
// of the held-out run, where there is one.
double ScoreOf(const std::vector<double>& errors, double best_validation);

// A round of all starts. Once each has made StartStepsOf(options) steps the returned round is that of the
// best alone, as if there had been no others; its State names a blob `starts` for the result:
// `starts/error_m`, the score of each, and `starts/chosen`.
Step AdvanceStarts(const Options& options, std::uint64_t seed, const State& state, Partials& partials,
                   const Inputs& inputs);

// Of a round of all starts, after so many steps, each of which expects to go on to the end: one alone does.
void ExpectTrials(const Options& options, std::int64_t steps_done, int starts, proto::Step* plan);

}  // namespace cairn::landmark_learning
