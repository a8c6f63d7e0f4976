// A task of an E-step: one time slice of one robot's steps ([TBF98] section 4.1). Alpha and beta tables never
// leave it, but for those at its ends.
#pragma once

#include "pipelines/landmark_map/options.h"
#include "pipelines/pipeline.h"

namespace cairn::landmark_map {

// Tasks of kind `forward` return alpha/… of their last step and `end`, the step after it; those of kind
// `backward` a partial (PartialBuilder) with beta/… of the step before their first. Throws NoPathError where
// no path fits.
Blob RunSlice(const Options& options, const Task& task, const Inputs& inputs, Progress& progress);

}  // namespace cairn::landmark_map
