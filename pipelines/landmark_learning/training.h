// What a training run knows when a step begins.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "pipelines/landmark_learning/descent.h"
#include "pipelines/landmark_learning/networks.h"
#include "pipelines/landmark_learning/options.h"

namespace cairn::landmark_learning {

inline constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// What the State holds besides `data`: the weights that a step starts from, those that did best on the
// held-out run, the optimiser's memory, a row a step.
struct Training {
  std::vector<double> weights, best;
  Descent descent;
  std::vector<double> error, validation, norm;
  double prior = 0.0, validation_prior = kNone;
  std::int64_t since_best = 0;  // looks at the held-out run

  Blob ToBlob() const;
  static Training FromBlob(const Blob& blob);
};

// As the options ask for.
NetworkShape ShapeOf(const Options& options, std::size_t inputs);
DescentRules RulesOf(const Options& options);

Parameters<float> InFloat(const NetworkShape& shape, const std::vector<double>& weights);

}  // namespace cairn::landmark_learning
