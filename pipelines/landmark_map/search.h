// The way out of bad optima: EM from several starts, of which the data choose one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipelines/landmark_map/plan.h"
#include "pipelines/landmark_map/summary.h"

namespace cairn::landmark_map {

// The constant drifts that are taken off the first robot's odometry where EM starts, one a candidate: evenly
// spread over two standard deviations of the nominal drift to either side.
std::vector<double> StartDrifts(const Settings& settings);

// Where EM of the first robot ended from one start.
struct Candidate {
  double start_drift_rad_per_m = 0.0;
  double drift_rad_per_m = 0.0;  // in the end
  double log_likelihood = 0.0;
  std::vector<Landmark> landmarks;
  std::optional<std::string> failure;  // why EM could not go on
};

// The log-likelihood, less the logarithm of the number of places for each landmark: another landmark raises
// the likelihood of any map, so it must pay for being told where it stands; and less what the drift's prior
// says against the drift that was found: with a drift that is large enough a square is a triangle.
double ScoreOf(const Candidate& candidate, const Settings& settings);

// Do the maps hold the same landmarks? So many each, and each one's nearest in the other map is its own.
bool SameMap(const std::vector<Landmark>& a, const std::vector<Landmark>& b);

struct Choice {
  int best = 0;
  // By how many nats the best one's score exceeds that of the best one with another map; none: all agree.
  std::optional<double> lead_nats;
};

// Throws InputError, the first candidate's, where all failed. Of equals the first is best.
Choice Choose(const std::vector<Candidate>& candidates, const Settings& settings);

// What the result says of the search; fields as in schema/FORMAT.md, search/.
Blob ToBlob(const std::vector<Candidate>& candidates, const Choice& choice, const Settings& settings);

std::string Sentence(const std::vector<Candidate>& candidates, const Choice& choice);

}  // namespace cairn::landmark_map
