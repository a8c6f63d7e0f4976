// What the run that was held out can tell of networks: how much of it lies where the others have been,
// whether it was recorded by itself, and whether it goes with them.
#pragma once

#include "pipelines/landmark_learning/data/training_data.h"
#include "pipelines/landmark_learning/networks/networks.h"
#include "pipelines/landmark_learning/state/options.h"
#include "schema/kinds/learning.h"

namespace cairn::landmark_learning {

// schema/FORMAT.md, `networks`, `held_out/`: of 500 samples that are evenly spread over the run, where it has
// more. `known_share` is left out; all is, where no run is held out.
kinds::Networks::HeldOut CheckHeldOut(const Options& options, const TrainingData& data,
                                      const Parameters<float>& networks);

}  // namespace cairn::landmark_learning
