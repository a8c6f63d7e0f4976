// How wrong a localised robot is after such a distance ([Thr98] section 5.2.4, figure 6).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "datasets/evaluate/reduction_interval.h"
#include "datasets/evaluate/scores.h"
#include "schema/blob.h"
#include "schema/geometry.h"

namespace cairn::datasets {

// Over the traverses that got as far.
struct MeanError {
  double mean_m = 0;
  std::optional<Interval> interval_95;  // Student's, over traverses; none of a single one
};

// After as many sensations, from none on.
struct LocalizationRow {
  std::int64_t sensations = 0, traverses = 0;
  double travelled_m = 0;  // mean
  MeanError believed;      // [Thr98] eq. 21: the mean over the belief of the distance to the true position
  MeanError mean;          // of the belief's mean from the true position
  // Of its most likely position; none while nothing is sensed and every position is as likely.
  std::optional<MeanError> mode;
  double within_1m = 0;  // share of traverses whose mean is that near
  // Mean over the traverses of what is believed of facing as it does; where headings count.
  double facing = 0;
};

// Of one step of one traverse.
struct LocalizationError {
  std::size_t sensations = 0;
  double travelled_m = 0;
  Point truth;
  double believed_m = 0, mean_m = 0, mode_m = 0, facing = 0;  // as above
};

struct LocalizationScore {
  std::int64_t traverses = 0, positions = 0;
  double window_m = 0;                      // of the belief at the start; 0: it knew nothing
  std::vector<std::string> features, runs;  // that were localised in
  bool against_truth = false;               // the samples' truth/; else their labels
  std::string heading = {};  // known or unknown to the robot; empty where headings do not count
  std::vector<LocalizationRow> rows;
  // Distance from which on the mean of `believed` stays under 1 m, over the rows of all traverses; none where
  // it does not.
  std::optional<double> under_1m_after_m;
  std::vector<LocalizationError> steps;  // as in the result, one after the other
};

// `result`: of kind `localization`; `samples`: what it was made from. True positions are `truth/run/N/x_m`
// and `y_m` where they are there, else the labels `run/N/x_m`, `y_m`. Throws InputError that says so: other
// samples, arrays that do not fit.
LocalizationScore EvaluateLocalization(const Blob& result, const Blob& samples);

Scores MakeScores(const LocalizationScore& score);

}  // namespace cairn::datasets
