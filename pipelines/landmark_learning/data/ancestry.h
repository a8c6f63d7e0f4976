// A finished run that this one goes on from: its weights, and what the result says of where it comes from.
#pragma once

#include <string>
#include <vector>

#include "pipelines/landmark_learning/data/training_data.h"
#include "pipelines/landmark_learning/networks/networks.h"
#include "schema/kinds/learning.h"

namespace cairn::landmark_learning {

struct Parent {
  std::vector<double> weights;  // in the order of Parameters
  InputNorm norm;               // the weights mean nothing under another one
};

// From a file that was checked as of kind `networks`.
// Throws InputError where it is none, or has other networks than `wanted`, or other inputs than
// `input_names`.
Parent ReadParent(const Blob& networks, const NetworkShape& wanted,
                  const std::vector<std::string>& input_names);

// `parent` itself and all before it.
kinds::Networks::Ancestry AncestryOf(const Blob& parent);

}  // namespace cairn::landmark_learning
