// Walls missed against false obstacles, of the same maps at every threshold: which of them is better at
// equal false cells, whatever probability counts as occupied.
#pragma once

#include <vector>

#include "datasets/reproduce/occupancy/panels.h"
#include "datasets/reproduce/paper_figure.h"

namespace cairn::datasets {

// Over all hallways of the study.
PaperFigure ThresholdFigure(const OccupancyStudy& study, const StageResults& results);

// A point of a map's curve, a mean over maps.
struct ThresholdPoint {
  double false_cells = 0, missed_share = 0, doors_right_share = 0;
};
// The least share that is missed by points of at most so many false cells; 1 where there is none.
double LeastMissed(const std::vector<ThresholdPoint>& curve, double most_false_cells);

}  // namespace cairn::datasets
