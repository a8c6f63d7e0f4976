// The cells of laser rays.
#pragma once

#include "pipelines/evidence_map/counts.h"
#include "pipelines/pipeline.h"

namespace cairn::evidence_map {

// Counts a ray's end as occupied, and the cell that the ray crosses the middle of each column with (each row,
// where it is steep) as free, from its beginning to before its end: about as many cells as the longer side of
// the ray is long. Rays end at the grid's border. Held-out scans are passed over.
Counts CountRays(const RangeScans& scans, const GridBox& grid, bool use_no_return, Progress& progress);

}  // namespace cairn::evidence_map
