// Adaptation to a corridor that has changed ([Thr98] section 7): a robot that knows roughly where it is
// labels what it senses by its own estimates, and goes on learning from that.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "datasets/reproduce/ball/study.h"
#include "datasets/reproduce/paper_figure.h"

namespace cairn::datasets {

// Half of what can be replaced in the corridor has been.
inline constexpr double kChangedShare = 0.5;

// The first job: networks trained on three runs before the change ("networks"); the robot then keeps track of
// itself in three runs after it ("track"), its start known to within 2 m.
BallJob MakeAdaptJob(std::uint64_t seed, const BallRecipe& recipe);

// The second, of the first's results: the networks trained on with what the robot labelled itself
// ("adapted"), others trained with that from the beginning ("anew"), and others with the simulator's labels
// ("labelled").
BallJob ContinueAdaptJob(const BallJob& first, const BallRecipe& recipe,
                         const std::map<std::string, Blob>& results);

// Samples at the stops of a `localization`, at the means of its beliefs; runs as they were driven.
Blob SelfLabelled(const Blob& samples, const Blob& located);

struct AdaptScores {
  double label_error_m = 0;                 // mean distance of the robot's labels from the truth
  std::map<std::string, double> reduction;  // +-2 m, in a fourth run, by row of the table
};

// `results`: of both jobs.
AdaptScores ScoreAdaptJob(const BallJob& first, const std::map<std::string, Blob>& results);

std::vector<PaperFigure> AdaptFigures(const std::vector<AdaptScores>& scores);

}  // namespace cairn::datasets
