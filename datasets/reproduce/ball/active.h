// Active sensing ([Thr98] section 7): a robot that has one camera and points it, at each stop, where the
// least error is to be expected, against one that always looks the same way.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "datasets/evaluate/learning/localization.h"
#include "datasets/reproduce/ball/study.h"
#include "datasets/reproduce/paper_figure.h"

namespace cairn::datasets {

// D-1, D-2 and D-3 of one corridor as if of one robot: at each sample of D-1 it also senses, with sonars and
// all, what a robot sensed that was nearest along the corridor (by true positions) in the run of the same
// number in the other sets. Inputs are called "d1 row 0 red", ….
Blob ThreeDirections(const std::vector<Blob>& sets);

// Networks for each direction, trained on the same samples; stages "d1", "d2", "d3", "turn", "active", "all".
BallJob MakeActiveJob(std::uint64_t seed, const BallRecipe& recipe);

// By stage.
using ActiveScores = std::map<std::string, LocalizationScore>;
ActiveScores ScoreActiveJob(const BallJob& ball, const std::map<std::string, Blob>& results);

std::vector<PaperFigure> ActiveFigures(const std::vector<ActiveScores>& scores);

}  // namespace cairn::datasets
