// Which way the sum over pairs is made: decided from the samples' number and positions alone.
#pragma once

#include <string>

#include "pipelines/landmark_learning/error_sum/pairs.h"
#include "pipelines/landmark_learning/state/options.h"
#include "schema/kinds/fields.h"

namespace cairn::landmark_learning {

enum class SumPath {
  kPairs,  // every pair in reach
  kLine,   // LineSums
  kTree,   // TreeSums
};

// Made once, when training starts; it goes with the data.
struct SumPlan {
  SumPath path = SumPath::kPairs;
  Positions projected = {};  // onto the line, where that changes positions: x_m is the way along it, y_m zero
  std::string text;          // the path and what it may be off by, for people

  const Positions& PositionsOf(const Positions& samples) const {
    return projected.size() > 0 ? projected : samples;
  }
  static void Fields(const auto& field) {
    field("path", &SumPlan::path);
    field("projected", &SumPlan::projected);
    field("text", &SumPlan::text);
  }
};

// As the options ask for.
Belief BeliefOf(const Options& options);
ErrorRule ErrorOf(const Options& options);

// Whether each block of true positions would cost a sweep over all samples: then one does it.
bool IsOneSweep(const Options& options, const SumPlan& plan);

// What the options force costs nothing to plan.
// Throws InputError where they force a path that these samples, belief and error do not allow.
SumPlan PlanSum(const Options& options, const Positions& positions);

// Of E and its gradient by P(f | s), for each of the 2^n: counted as the pairs' are, 8 a pair in reach.
double FlopsPerVector(const Options& options, SumPath path, const Positions& positions);

}  // namespace cairn::landmark_learning
