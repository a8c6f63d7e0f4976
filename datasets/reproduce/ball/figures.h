// The tables and figures of [Thr98] from the scores of the study's jobs, each beside the paper's.
#pragma once

#include <vector>

#include "datasets/reproduce/ball/scores.h"
#include "datasets/reproduce/paper_figure.h"

namespace cairn::datasets {

// Means over seeds with Student's 95% interval over them (none of a single seed). Figures 5, 7 and 8 are of
// the first seed. `scores`: of every set the same seeds.
std::vector<PaperFigure> BallFigures(const std::vector<BallScores>& scores);

}  // namespace cairn::datasets
