// On which logs it was measured how often a map is right of which a search says so much ("Confidence" in the
// README): what that says of another log is not known.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pipelines/landmark_map/state/options.h"
#include "schema/blob.h"

namespace cairn::landmark_map {

// What tells logs of one robot that presses buttons apart.
struct LogStatistics {
  double observations = 0;
  double travelled_m = 0;
  double between_m = 0;  // the median distance from one observation to the next
  // From the tenth part of these distances that is shortest to the longest tenth, over the median: of
  // landmarks at even distances, as on a ring, it is nothing, and any of them may be taken for the next.
  double between_spread = 0;
  double heading_drift_rad_per_m = 0, heading_walk_rad_per_sqrt_m = 0, forward_ratio = 0, turn_ratio = 0;
  double contact_m = 0;  // these as the log states them; 0: it does not
};
LogStatistics MeasureLog(const Blob& log);

// The first of them, which are measured; the others are those of the log's `noise/`, and of the options of
// the imports (schema/kinds/log.h).
inline constexpr std::size_t kMeasuredFigures = 4;
// Calls f(name, field) for each of them.
template <class S, class F>
void VisitLogStatistics(S& statistics, const F& f) {
  f("observations", statistics.observations);
  f("travelled_m", statistics.travelled_m);
  f("between_m", statistics.between_m);
  f("between_spread", statistics.between_spread);
  f("heading_drift_rad_per_m", statistics.heading_drift_rad_per_m);
  f("heading_walk_rad_per_sqrt_m", statistics.heading_walk_rad_per_sqrt_m);
  f("forward_ratio", statistics.forward_ratio);
  f("turn_ratio", statistics.turn_ratio);
  f("contact_m", statistics.contact_m);
}

// In what a job differs from all that the rates were measured on, in words: "it has 4 robots". Empty: it is
// like them. `landmarks`: of the map that was found.
std::vector<std::string> UnlikeMeasured(const Options& options, const Blob& log, std::size_t landmarks);

}  // namespace cairn::landmark_map
