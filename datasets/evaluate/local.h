// How good a `local_map` is: its path and the positions in its traces, the direction of walls, its loops.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "datasets/evaluate/clock.h"
#include "datasets/evaluate/matching/similarity.h"
#include "datasets/evaluate/scores.h"
#include "schema/blob.h"
#include "schema/geometry.h"

namespace cairn::datasets {

// Distances of positions from the true ones.
struct PathError {
  std::int64_t poses = 0;
  double rmse_m = 0, mean_m = 0, worst_m = 0;
};

// Of the times after the first lock at which walls that are turned neither are about nor are believed to be.
struct WallScore {
  std::int64_t scans = 0;
  double error_deg = 0;     // mean
  double within_2_deg = 0;  // share of the scans
  double first_lock_s = 0;  // the latest of the robots'; since its first scan
  // Of the scans about which walls are turned, how many were told from the others, and of the others how
  // many were taken for such; none: there are none.
  std::optional<double> other_area_found, other_area_false;
};

struct LoopScore {
  std::int64_t found = 0;     // that the optimized path follows
  std::int64_t wrong = 0;     // of these: the truth has the robot elsewhere by more than half a metre
  std::int64_t rejected = 0;  // matched, and contradicted by others
  std::int64_t rejected_wrong = 0;
  double mean_m = 0;  // by which those that are right are off; 0: there are none
};

struct LocalEvaluation {
  PathError path, odometry;               // after a rigid motion of each robot's: each has a frame of its own
  double heading_rmse_deg = 0;            // of the path
  std::optional<OtherClock> other_clock;  // that the truth may have
  std::optional<PathError> traces;  // the live positions, each in its trace's frame, which the truth places
  PathError traces_odometry;        // of odometry alone at the same times, since each trace was recorded
  double corrected = 0;             // share of these at which matching corrected something
  std::optional<WallScore> walls;   // none: no direction was found, or the truth has none
  LoopScore loops;
  std::int64_t trace_count = 0, cuts = 0;
  std::optional<double> seconds;      // wall time, where the result's provenance tells it
  std::vector<Similarity> alignment;  // of each robot's path
};

// `result`: a `local_map`; `log`: what it was made from, with true poses. A trace's frame lies where the
// truth has the robot while it recorded it.
// Throws InputError that says so: a result without what is needed, another log, no true poses.
LocalEvaluation EvaluateLocal(const Blob& result, const Blob& log);

Scores MakeScores(const LocalEvaluation& evaluation);

}  // namespace cairn::datasets
