// Which way the sum over pairs is made: decided from the samples' number and places alone.
#pragma once

#include <string>

#include "pipelines/landmark_learning/options.h"
#include "pipelines/landmark_learning/pairs.h"

namespace cairn::landmark_learning {

enum class SumPath {
  kPairs,  // every pair in reach
  kLine,   // LineSums
  kTree,   // TreeSums
};

struct SumPlan {
  SumPath path = SumPath::kPairs;
  Places places;  // as that path takes them: for kLine x_m is the way along the line, y_m zero
  double flops_per_vector = 0.0;  // of E and its gradient by P(f | s), each of the 2^n
  std::string text;               // the path and what it may be off by, for people
};

// As the options ask for.
Belief BeliefOf(const Options& options);
ErrorRule ErrorOf(const Options& options);

// Whether each block of truths would cost a sweep over all samples: then one does it.
bool IsOneSweep(const Options& options, const SumPlan& plan);

// Throws InputError where the options force a path that these samples, belief and error do not allow.
SumPlan PlanSum(const Options& options, const Places& places);

}  // namespace cairn::landmark_learning
