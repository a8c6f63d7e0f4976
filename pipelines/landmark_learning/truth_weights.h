// P(xi*): how much each true position counts ([Thr98] eq. 23).
#pragma once

#include "pipelines/landmark_learning/data/training_data.h"
#include "pipelines/landmark_learning/state/options.h"

namespace cairn::landmark_learning {

// As options.true positions says: each sample alike; each half metre of space alike, however many samples it
// holds; or by the array run/N/weight of the samples. Of both sets, each adding up to 1. Throws InputError
// where such an array is missing, or all weights of a set are zero.
void WeighTruePositions(const Options& options, TrainingData* data);

}  // namespace cairn::landmark_learning
