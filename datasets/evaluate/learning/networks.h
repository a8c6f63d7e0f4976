// How well learned networks localise where they were not trained: BaLL's error reduction ([Thr98] eq. 46,
// sections 5.1.5 to 5.1.8).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "datasets/evaluate/learning/window_scores.h"
#include "schema/blob.h"

namespace cairn::datasets {

struct NetworkEvaluation {
  std::int64_t networks = 0, training_samples = 0;
  double trained_window_m = 0;  // kGlobal: for global uncertainty
  bool headings = false;        // count (HeadingsCount); options.heading_window_deg then has a value
  ScoreOptions options;
  std::vector<RunSize> runs;            // that are held out
  std::vector<std::string> trained_on;  // left out of the samples
  // Of `runs`, those that decided when to stop training: not wholly unseen.
  std::vector<std::string> stopped_by;
  std::vector<WindowScore> windows;
};

// `networks`, `samples`: files of kind `networks` and `samples` (schema/FORMAT.md). Evaluation is not
// training: the true positions are those of the held-out samples, the positions that the robot may believe in
// are those of the training samples, e is the distance, and beliefs are uniform over the training samples
// within the window, and within that of the heading (HeadingsCount). A run that the networks were trained on
// is left out. Intervals are taken over runs where at least two have true positions that count, else over ten
// blocks of consecutive samples. Throws InputError as ReadLearnedNetworks and ReadHeldOutRuns do, and where
// `nearest` is not from 1 to the number of training samples.
NetworkEvaluation EvaluateNetworks(const Blob& networks, const Blob& samples,
                                   const ScoreOptions& options = {});

// A row for each window; null: there is none, or a window that is global.
Scores MakeScores(const NetworkEvaluation& evaluation);

}  // namespace cairn::datasets
