// How good a landmark map and its trajectories are, measured against ground truth.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "datasets/evaluate/calibration.h"
#include "datasets/evaluate/clock.h"
#include "datasets/evaluate/frame.h"
#include "datasets/evaluate/matching/point_match.h"
#include "datasets/evaluate/matching/similarity.h"
#include "datasets/evaluate/scores.h"
#include "schema/blob.h"

namespace cairn::datasets {

// Extracted landmarks against those true ones that were observed: one to one, the matching of the least
// GOSPA, after the alignment. Where a landmark's identity is known only the true one of the same name will
// do.
struct LandmarkScore {
  std::int64_t found = 0;        // true ones with a match closer than the cut-off of 3 m
  std::int64_t missed = 0;       // true ones without
  std::int64_t spurious = 0;     // extracted ones without
  std::int64_t within_3m = 0;    // pairs closer than 3 m: as `found`, whose cut-off it is
  std::optional<double> rmse_m;  // of the pairs; none: no pair
  // Of the same pairs, after their own best alignment with a scale.
  std::optional<double> rmse_similarity_m;
  double gospa_m = 0;  // cut-off 3 m, alpha 2, p 2
};

struct RobotScore {
  std::string name;
  // Of the most likely pose's position, after the alignment; none: no true poses.
  std::optional<double> rmse_m;
  std::optional<double> heading_rmse_rad;
  std::int64_t poses = 0;  // that were compared
};

struct Evaluation {
  std::optional<LandmarkScore> landmarks;   // none: the truth has no landmarks
  std::optional<double> trajectory_rmse_m;  // the worst robot's
  std::string no_trajectory;                // why there is none
  std::optional<OtherClock> other_clock;    // that the truth may have
  // That true poses may have, and true landmarks; of landmarks whose identities are known.
  std::optional<OtherFrame> other_frame, other_landmark_frame;
  std::vector<RobotScore> robots;
  std::optional<bool> topology_correct;  // matching/associations.h; none: the truth has no associations
  // Where it has: observations that are truly of a landmark, and those of them that are in none of the map's;
  // observations that are in one, and those of them that are truly of another, or of nothing.
  std::int64_t observations = 0, unused = 0, associations = 0, wrong = 0;
  Calibration calibration;
  std::int64_t iterations = 0;     // of the expectation maximisation, that without a map included
  std::optional<double> seconds;   // wall time, where the result's provenance tells it
  std::string refinement_refused;  // why its landmarks are not refined; empty: it was not refused

  // How the result lies over the truth: one rigid motion for all robots and landmarks.
  std::string aligned_on;  // "poses", "landmarks" or "nothing"
  Similarity alignment;
  double scale = 1;                                          // of the alignment with a scale
  std::vector<std::pair<std::int64_t, std::int64_t>> pairs;  // (extracted, index into truth/landmarks)
};

// `result`: a `landmark_map`; `truth_log`: the log that it was made from, with its truth (schema/FORMAT.md).
// The alignment is the least-squares one over the time-stamped most likely poses of all robots where the
// truth has poses; else that of the landmarks whose identities are known; else the one with the least GOSPA
// that a search finds. A true landmark counts as observed where the true associations name it; for a robot
// without them, where its observations name it; all count where neither tells. A result of a prefix of the
// data (`until_s`) is not asked for what was observed later. `point`: as Calibrate takes it.
// Throws InputError that says so: a result without what is needed, robots that differ from the log's, a log
// whose content, truth aside, is not what the result was made from, no truth.
Evaluation Evaluate(const Blob& result, const Blob& truth_log, const ReferencePoint& point = {});

// As the page docs/evaluate.md has them.
Scores MakeScores(const Evaluation& evaluation);

}  // namespace cairn::datasets
