// Figures 1 and 2 of [Thr01] (occupancy_study.h): what can be seen by hand.
#pragma once

#include "datasets/reproduce/occupancy/panels.h"
#include "datasets/reproduce/paper_figure.h"

namespace cairn::datasets {

// Figure 1: two crossing cones. Counts the cells where the short reading's end crosses what the long one says
// is free.
PaperFigure CrossingFigure(const OccupancyStudy& study, const StageResults& results);

// Figure 2: p(z | m) of two obstacles in a cone.
PaperFigure DensityFigure();

}  // namespace cairn::datasets
