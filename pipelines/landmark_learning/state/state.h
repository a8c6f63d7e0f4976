// What a training run knows when a step begins.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "pipelines/landmark_learning/networks/networks.h"
#include "pipelines/landmark_learning/optimizer/conjugate.h"
#include "pipelines/landmark_learning/optimizer/descent.h"
#include "pipelines/landmark_learning/state/history.h"
#include "pipelines/landmark_learning/state/options.h"

namespace cairn::landmark_learning {

// What a round does.
enum class Phase : std::int32_t {
  kGradient,        // dE/dw
  kSearch,          // E at several positions along a line (method conjugate)
  kOutputGradient,  // dE/dg (method pseudo)
  kFit,             // each network to its targets (method pseudo)
  // The first or the third as rounds of their own, where each block of true positions reaches most samples:
  kOutputs,  // g of all samples
  kPairs,    // dE/dg
  kWeights,  // dE/dw
};

// Networks end and above are not in use yet; of those below, the ones from `first` on learn.
struct Learning {
  int first, end;
  static void Fields(const auto& field) {
    field("first", &Learning::first);
    field("end", &Learning::end);
  }
};

inline constexpr std::size_t kMostWarnings = 50;
inline constexpr std::int64_t kRisingSteps = 10;

struct Training {
  Phase phase = Phase::kGradient;
  std::int64_t steps = 0;          // made
  std::int64_t network_steps = 0;  // of them, since the last network came into use
  Learning learning{0, 1};
  std::vector<double> weights, best;  // that the step starts from; that did best on the held-out run
  Descent descent;                    // of those that learn
  Conjugate conjugate;                // the same
  History history;
  double prior = 0.0, validation_prior = kNone;
  double best_validation = std::numeric_limits<double>::infinity();
  std::int64_t since_best = 0;  // looks at the held-out run
  double last_error = kNone;
  std::int64_t rising = 0;              // steps in a row that raised the error
  std::vector<std::string> warnings;    // for people, in the order of the steps; no more than kMostWarnings
  std::vector<std::int32_t> saturated;  // networks whose gradient was exactly zero at the last step

  // Into the State, as the blobs `parameters`, `best` (once there are any) and `training`, and those of the
  // history. What has not changed since `before` is named again, not made again.
  void Share(const State& before, const Inputs& inputs, Step* step);
  // As others hand it on. Throws InputError where it does not fit itself, or networks of this shape.
  static Training Of(const Options& options, const NetworkShape& shape, const Inputs& inputs);

  // `sequential`: the next network joins, the one before it as it was best.
  void NextNetwork();

  // What a step found: the error before it, the same of the held-out run (NaN: not looked at).
  void Record(double error, double validation, double gradient_norm);
  // What is wrong with the step that was recorded last, and was not before it: a network whose gradient is
  // exactly zero, an error that has risen for ten steps running. Empty: nothing.
  std::string Warn(const std::vector<std::int32_t>& now_saturated);

  // But for the weights, which are blobs of their own.
  static void Fields(const auto& field) {
    field("phase", &Training::phase);
    field("steps", &Training::steps);
    field("network_steps", &Training::network_steps);
    field("learning", &Training::learning);
    field("descent", &Training::descent);
    field("conjugate", &Training::conjugate);
    field("history", &Training::history);
    field("prior", &Training::prior);
    field("validation_prior", &Training::validation_prior);
    field("best_validation", &Training::best_validation);
    field("since_best", &Training::since_best);
    field("last_error", &Training::last_error);
    field("rising", &Training::rising);
    field("warnings", &Training::warnings);
    field("saturated", &Training::saturated);
  }

 private:
  void Check(const Options& options, const NetworkShape& shape) const;

  bool best_is_new_ = false;
};

// As the options ask for.
NetworkShape ShapeOf(const Options& options, std::size_t inputs);
DescentRules RulesOf(const Options& options);
Learning FirstLearning(const Options& options);

// Those of a blob `parameters`, for the networks to compute with.
// Throws InputError where they are of another shape.
Parameters<float> InFloat(const NetworkShape& shape, const Blob& weights);
Parameters<float> InFloat(const NetworkShape& shape, std::span<const double> weights);

}  // namespace cairn::landmark_learning
