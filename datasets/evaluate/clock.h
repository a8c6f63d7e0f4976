// Whether the truth was recorded by another clock than the log.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "datasets/evaluate/scores.h"
#include "datasets/evaluate/track.h"

namespace cairn::datasets {

// A robot's path, and the true one.
struct TrackAndTruth {
  Track path, truth;
};

// With `shift_s` added to the truth's times the paths are `rmse_m` off, after the rigid motion that is best.
struct OtherClock {
  double shift_s = 0, rmse_m = 0;
  std::string Text() const;
};

// The shift, one for all robots, under which the paths lie best on the true ones: up to five minutes, and
// where hardly a time is shared also those that let the first or the last times meet. Nothing where none
// makes the paths a third as far off as they are, of as many poses.
std::optional<OtherClock> FindOtherClock(const std::vector<TrackAndTruth>& robots);

// `trajectory.clock_…`
void AddClock(const std::optional<OtherClock>& clock, Scores* scores);

}  // namespace cairn::datasets
