// A task of an E-step: one time slice of one robot's steps ([TBF98] section 4.1). Alpha and beta tables never
// leave it, but for those at its ends.
#pragma once

#include "pipelines/landmark_map/state/options.h"
#include "pipelines/pipeline.h"

namespace cairn::landmark_map {

// Tasks of kind `guess` return what both of the following would, from guesses of the tables at the slice's
// ends; or nothing, where the guesses lead nowhere. The others take it where the guesses turn out right.
// Tasks of kind `forward` return alpha/… of their last step and `end`, the step after it; those of kind
// `backward` a partial (PartialBuilder) with beta/… of the step before their first, with warm/… for the next
// round's guess (speculation.h) where that may need it, and `confirmed` (1 or 0) where there was a guess.
// Throws NoPathError where no path fits.
Blob RunSlice(const Options& options, const Task& task, const Inputs& inputs, Progress& progress);

}  // namespace cairn::landmark_map
