// The cells of sonar cones.
#pragma once

#include "pipelines/evidence_map/counts.h"
#include "pipelines/pipeline.h"

namespace cairn::evidence_map {

struct ConeModel {
  double wall_m;  // how far from the range a cell is still at it, to which half a cell is added
  bool graded;
};

// An inverse model of a sonar, after A. Elfes, Occupancy Grids, 1989 (the shapes, with log-odds in place of
// probabilities): the cells of the cone at the range, `wall_m` and half a cell to either side, count as
// occupied, those before as free. Graded: times 1 - (angle / half the opening)^2, and a free cell times
// 1 - (distance / range)^2, an occupied one times 1 - (distance from the range / half the wall's width)^2; in
// whole parts of kWhole, 1 at least. Held-out scans are passed over.
Counts CountCones(const RangeScans& scans, const GridBox& grid, const ConeModel& model, bool use_no_return,
                  Progress& progress);

}  // namespace cairn::evidence_map
