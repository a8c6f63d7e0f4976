// What a training run knows when a step begins.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "pipelines/landmark_learning/descent.h"
#include "pipelines/landmark_learning/history.h"
#include "pipelines/landmark_learning/networks.h"
#include "pipelines/landmark_learning/options.h"

namespace cairn::landmark_learning {

struct Training {
  std::vector<double> weights, best;  // that the step starts from; that did best on the held-out run
  Descent descent;
  History history;
  double prior = 0.0, validation_prior = kNone;
  double best_validation = std::numeric_limits<double>::infinity();
  std::int64_t since_best = 0;  // looks at the held-out run

  // Into the State, as the blobs `weights`, `best` (once there are any) and `training`, and those of the
  // history. What has not changed since `before` is named again, not made again.
  void Share(const State& before, const Inputs& inputs, Step* step);
  static Training Of(const Inputs& inputs);

  // What a step found: the error before it, the same of the held-out run (NaN: not looked at).
  void Record(double error, double validation, double gradient_norm);

 private:
  bool best_is_new_ = false;
};

// As the options ask for.
NetworkShape ShapeOf(const Options& options, std::size_t inputs);
DescentRules RulesOf(const Options& options);

// Those of a blob `weights`, for the networks to compute with. Throws InputError where they are of another
// shape.
Parameters<float> InFloat(const NetworkShape& shape, const Blob& weights);
Parameters<float> InFloat(const NetworkShape& shape, std::span<const double> weights);

}  // namespace cairn::landmark_learning
