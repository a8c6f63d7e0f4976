// The arrays networks/… of a file of kind `networks` (schema/FORMAT.md).
#pragma once

#include "pipelines/landmark_learning/networks/networks.h"
#include "schema/blob.h"

namespace cairn::landmark_learning {

// Weights and biases, in double.
void PutNetworkArrays(const Parameters<float>& parameters, Blob* file);

// Throws InputError that names the array: one that is missing, of a shape that does not fit the others, with
// a number that is not finite.
Parameters<double> NetworksIn(const Blob& file);

}  // namespace cairn::landmark_learning
