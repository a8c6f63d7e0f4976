// The baseline that [TBF98] section 6 conjectures to be bound to fail: one pass forward in time. Each
// observation is looked at once, in a map of those before it; what it adds to the map, and where the robot
// was believed to be, is never revised.
#pragma once

#include "pipelines/landmark_map/state/options.h"
#include "pipelines/pipeline.h"

namespace cairn::landmark_map {

// A task of kind `incremental`, which is the whole job: all steps of the one robot. Partial: as a `backward`
// task's with summaries, and the landmarks in the end, landmarks/….
Blob RunIncremental(const Options& options, const Task& task, const Inputs& inputs, Progress& progress);

// The stage's result, of that partial.
cairn::Step IncrementalResult(const Options& options, const State& state, Partials& partials,
                              const Inputs& inputs);

// Throws InputError for what one pass cannot take: several robots, a given map, the exact model.
void CheckIncremental(const Options& options, const Inputs& inputs);

// The options of that one pass: no iterations, no search, nothing after it.
Options OnePass(Options options);

}  // namespace cairn::landmark_map
