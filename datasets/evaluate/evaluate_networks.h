// How well learned networks localise where they were not trained: BaLL's error reduction ([T98] eq. 46; S.
// Thrun, Bayesian landmark learning for mobile robot localization, Machine Learning 33, 1998, sections 5.1.5
// to 5.1.8).
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "datasets/evaluate/reduction_interval.h"
#include "schema/blob.h"

namespace cairn::datasets {

inline constexpr double kGlobal = std::numeric_limits<double>::infinity();

struct NetworkEvaluationOptions {
  int nearest = 5;         // k training samples, of which P(f | xi) is made
  int samplings = 20;      // of f, for each held-out sample
  std::uint64_t seed = 1;  // of the samplings and of the bootstrap
  std::vector<double> windows_m = {1, 2, 5, 10, 50, 89, kGlobal};            // half-widths, ascending
  std::string networks_name = "the networks", samples_name = "the samples";  // files, for messages
};

struct Score {
  double posterior_error_m = 0;
  std::optional<double> error_reduction;  // none: the prior error is zero
  std::optional<Interval> interval_95;    // none: nothing to take it over
};

struct WindowScore {
  double window_m = 0;        // kGlobal: globally uncertain
  std::int64_t truths = 0;    // held-out samples that count
  std::int64_t left_out = 0;  // those without a training sample in the window
  double prior_error_m = 0;   // this and the scores mean nothing where no truth counts
  Score soft;                 // the expectation over f
  Score sampled;              // the mean over the samplings, and …
  double sampled_sd = 0;      // … the standard deviation of the reduction over them
  std::string interval_over;  // "runs", "blocks" (of consecutive samples); what is drawn by the bootstrap
  std::int64_t clusters = 0;  // how many of them
};

struct RunSize {
  std::string name;
  std::int64_t samples = 0;
};

struct NetworkEvaluation {
  std::int64_t networks = 0, training_samples = 0;
  double trained_window_m = 0;  // kGlobal: for global uncertainty
  NetworkEvaluationOptions options;
  std::vector<RunSize> runs;            // that are held out
  std::vector<std::string> trained_on;  // left out of the samples
  std::vector<std::string>
      stopped_by;  // of `runs`, those that decided when to stop training: not wholly unseen
  std::vector<WindowScore> windows;
};

// `networks`, `samples`: files of kind `networks` and `samples` (schema/FORMAT.md). Evaluation is
// not training: the true positions are those of the held-out samples, the positions that the robot may
// believe in are those of the training samples, e is the distance, and beliefs are uniform over the training
// samples within the window. A run that the networks were trained on is left out. Intervals are taken over
// runs where at least two have truths that count, else over ten blocks of consecutive samples. Throws
// InputError as ReadLearnedNetworks and ReadHeldOutRuns do, and where `nearest` is not from 1 to the number
// of training samples.
NetworkEvaluation EvaluateNetworks(const Blob& networks, const Blob& samples,
                                   const NetworkEvaluationOptions& options = {});

// {"networks": …, "windows": [{"window_m": …, "prior_error_m": …, "posterior_error_m": …, "error_reduction":
// …, "error_reduction_95": [low, high], …}, …]}; null: there is none, or a window that is global.
std::string NetworkEvaluationJson(const NetworkEvaluation& evaluation, int indent = 2);
// The same for people: a row for each window.
std::string NetworkEvaluationText(const NetworkEvaluation& evaluation);

}  // namespace cairn::datasets
