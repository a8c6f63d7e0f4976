// A finished run that this one goes on from: its weights, and what the result says of where it comes from.
#pragma once

#include <string>
#include <vector>

#include "pipelines/landmark_learning/data/training_data.h"
#include "pipelines/landmark_learning/networks/networks.h"
#include "schema/blob.h"

namespace cairn::landmark_learning {

struct Parent {
  std::vector<double> weights;  // in the order of Parameters
  InputNorm norm;               // the weights mean nothing under another one
};

// From a file of kind `networks`.
// Throws InputError where
// - it is none;
// - it has other networks than `wanted`, or other inputs than `input_names`;
// - a number is not finite, or a scale not above 0.
Parent ReadParent(const Blob& networks, const NetworkShape& wanted,
                  const std::vector<std::string>& input_names);

// ancestry/…, of `parent` and all before it, where there is one: schema/FORMAT.md.
void PutAncestry(const Blob& parent, Blob* result);

}  // namespace cairn::landmark_learning
