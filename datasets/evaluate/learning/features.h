// How well hand-made features localise (doors, lights: what a detector says of a sample), by the very
// measures that learned networks are scored with.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "datasets/evaluate/learning/window_scores.h"
#include "schema/blob.h"

namespace cairn::datasets {

struct FeatureEvaluation {
  std::vector<std::string> features;
  ScoreOptions options;
  bool headings = false;              // count (HeadingsCount)
  bool in_turn = false;               // each of `runs` was held out in its turn, the map was of the others
  std::vector<RunSize> runs;          // that are held out
  std::vector<std::string> map_runs;  // of whose samples the map is made, where not in turn
  std::vector<WindowScore> windows;
};

// Runs that are held out: those of `truth` that are not runs of `samples`; where there is no `truth`, those
// of `samples` that `holdout` names; where it names none, all, one after the other. Beliefs, errors and
// intervals are EvaluateNetworks'.
// Throws InputError as ReadFeatureRuns does; both `truth` and `holdout`; a `holdout` that is no run; nothing
// held out, or nothing left for the map.
FeatureEvaluation EvaluateFeatures(const Blob& samples, const Blob* truth,
                                   const std::vector<std::string>& features,
                                   const std::vector<std::string>& holdout = {},
                                   const ScoreOptions& options = {});

// How often a detector is right, over all samples; both say yes above 1/2.
struct Detection {
  std::string detector, truth;
  std::int64_t both = 0, only_detected = 0, only_true = 0, neither = 0;

  std::optional<double> precision() const;  // none: nothing was detected
  std::optional<double> recall() const;     // none: there was nothing to detect
};

// Throws InputError as ReadFeatureRuns does.
Detection CompareFeatures(const Blob& samples, const std::string& detector, const std::string& truth);

// As those of networks; with `detection` also its figures.
Scores MakeScores(const FeatureEvaluation& evaluation, const std::optional<Detection>& detection = {});

}  // namespace cairn::datasets
