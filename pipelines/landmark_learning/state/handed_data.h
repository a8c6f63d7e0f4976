// The blob `data`, which tasks and Advance read: what Start made of the samples, as others hand it on.
#pragma once

#include "pipelines/landmark_learning/data/training_data.h"
#include "pipelines/landmark_learning/state/options.h"
#include "pipelines/landmark_learning/state/sum_path.h"
#include "pipelines/pipeline.h"

namespace cairn::landmark_learning {

struct HandedData {
  TrainingData data;
  SumPlan sum;
};

// Throws InputError where arrays do not fit each other, or the options, or an index is none of theirs.
HandedData DataIn(const Options& options, const Inputs& inputs);

}  // namespace cairn::landmark_learning
