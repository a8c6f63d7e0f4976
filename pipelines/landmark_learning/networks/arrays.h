// The arrays networks/… of a file of kind `networks` (schema/FORMAT.md).
#pragma once

#include "pipelines/landmark_learning/networks/networks.h"
#include "schema/kinds/learning.h"

namespace cairn::landmark_learning {

// Weights and biases, in double; the inputs' names and normalisation are the caller's.
kinds::Networks::Weights WeightsOf(const Parameters<float>& parameters);

// Of a file that was checked as its kind.
// Throws InputError that names the array: one that is missing, or does not fit the last hidden layer.
Parameters<double> NetworksIn(const kinds::Networks::Weights& file);

}  // namespace cairn::landmark_learning
