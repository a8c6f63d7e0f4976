// Error reductions of a robot that knows its position within a window and senses once ([T98] eq. 46; S.
// Thrun, Bayesian landmark learning for mobile robot localization, Machine Learning 33, 1998), whatever its
// features are: learned or made by hand.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "datasets/evaluate/feature_map.h"
#include "datasets/evaluate/reduction_interval.h"

namespace cairn::datasets {

inline constexpr double kGlobal = std::numeric_limits<double>::infinity();

struct ScoreOptions {
  int nearest = 5;         // k training samples, of which P(f | xi) is made
  int samplings = 20;      // of f, for each held-out sample
  std::uint64_t seed = 1;  // of the samplings and of the bootstrap
  std::vector<double> windows_m = {1, 2, 5, 10, 50, 89, kGlobal};       // half-widths, ascending
  std::string map_name = "the networks", samples_name = "the samples";  // files, for messages
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

// A held-out sample: the run it is of, and its errors in each window.
struct Truth {
  std::size_t run;
  std::vector<WindowError> errors;
};

// A run that is held out.
struct SensedRun {
  std::size_t number = 0;  // tells it from the other runs, and seeds its samplings
  std::span<const double> x_m, y_m;
  std::span<const double> output;  // [samples][features]: P(f_i = 1 | s)
};

// Throws InputError where `options.nearest` is not from 1 to the number of training samples.
void CheckNearest(const ScoreOptions& options, std::size_t training_samples);

void AddTruths(const FeatureMap& map, const SensedRun& run, const ScoreOptions& options,
               std::vector<Truth>* truths);

// One for each window. Intervals are taken over runs where at least two have truths that count, else over ten
// blocks of consecutive samples. Truths of a run stand together.
std::vector<WindowScore> ScoreWindows(const std::vector<Truth>& truths, const ScoreOptions& options);

}  // namespace cairn::datasets
