// Error reductions of a robot that knows its position within a window and senses once ([Thr98] eq. 46),
// whatever its features are: learned or made by hand.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "datasets/evaluate/learning/feature_map.h"
#include "datasets/evaluate/reduction_interval.h"
#include "datasets/evaluate/reference.h"
#include "datasets/evaluate/scores.h"

namespace cairn::datasets {

inline constexpr double kGlobal = std::numeric_limits<double>::infinity();

struct ScoreOptions {
  int nearest = 5;         // k training samples, of which P(f | xi) is made
  int samplings = 20;      // of f, for each held-out sample
  std::uint64_t seed = 1;  // of the samplings and of the bootstrap
  std::vector<double> windows_m = {1, 2, 5, 10, 50, 89, kGlobal};  // half-widths, ascending
  // What the robot knows of its heading: positions whose samples face farther away are not believed in; none:
  // what the networks were trained for, and nothing (180) of features made by hand.
  std::optional<double> heading_window_deg = {};
  ReferencePoint reference_point = {};                                  // of landmark maps
  std::string map_name = "the networks", samples_name = "the samples";  // files, for messages
};

struct Score {
  double posterior_error_m = 0;
  std::optional<double> error_reduction;  // none: the prior error is zero
  std::optional<Interval> interval_95;    // none: nothing to take it over
};

struct WindowScore {
  double window_m = 0;              // kGlobal: globally uncertain
  std::int64_t true_positions = 0;  // held-out samples that count
  std::int64_t left_out = 0;        // those without a training sample in the window
  double prior_error_m = 0;         // this and the scores mean nothing where no truth counts
  Score soft;                       // the expectation over f
  Score sampled;                    // the mean over the samplings, and …
  double sampled_sd = 0;            // … the standard deviation of the reduction over them
  std::string interval_over;  // "runs", "blocks" (of consecutive samples); what is drawn by the bootstrap
  std::int64_t clusters = 0;  // how many of them
};

struct RunSize {
  std::string name;
  std::int64_t samples = 0;
};

// A held-out sample: the run it is of, and its errors in each window.
struct TruePosition {
  std::size_t run;
  std::vector<WindowError> errors;
};

// A run that is held out.
struct SensedRun {
  std::size_t number = 0;  // tells it from the other runs, and seeds its samplings
  std::span<const double> x_m, y_m;
  std::span<const double> output;            // [samples][features]: P(f_i = 1 | s)
  std::span<const double> heading_rad = {};  // [samples], where the map has headings
};

// The headings of a map's samples, those of the runs that are held out, and what robots know of theirs.
struct ScoredHeadings {
  std::vector<double> map_rad;
  std::vector<std::span<const double>> held_out_rad;
  std::size_t held_out = 0;  // samples
  double window_deg = 180;
};

// Whether headings count: P(f | position) is then of samples that face alike, and beliefs hold those in the
// heading's window. They do where all samples have one and they do not all face one way, or where there is a
// window.
// Throws InputError where there is a window and a sample without a heading.
bool HeadingsCount(const ScoredHeadings& headings, std::size_t map_samples);

// Throws InputError where `options.nearest` is not from 1 to the number of training samples.
void CheckNearest(const ScoreOptions& options, std::size_t training_samples);

// `options.heading_window_deg` has been decided where the map has headings.
void AddTruePositions(const FeatureMap& map, const SensedRun& run, const ScoreOptions& options,
                      std::vector<TruePosition>* true_positions);

// One for each window. Intervals are taken over runs where at least two have true positions that count, else
// over ten blocks of consecutive samples. True positions of a run stand together.
std::vector<WindowScore> ScoreWindows(const std::vector<TruePosition>& true_positions,
                                      const ScoreOptions& options);

// What is known of the position beforehand; where it is global, nothing.
void AddWindow(const std::string& name, double window_m, Scores* scores);
// What the map of features was made with, the runs that were held out, a row for each window.
void AddMapOptions(const ScoreOptions& options, bool headings, Scores* scores);
void AddRuns(const std::vector<RunSize>& runs, Scores* scores);
void AddWindows(const std::vector<WindowScore>& windows, Scores* scores);

}  // namespace cairn::datasets
