// `cairn import g2o`: a pose graph of the plane, as a log.
#pragma once

#include <string>

#include "datasets/import/log_rows.h"
#include "schema/blob.h"

namespace cairn::datasets {

struct G2oImportOptions {
  std::string file = {};  // plain or gzipped
  double step_s = 1;      // from each pose to the next: a graph has no times
  bool skip_bad = false;
  NoiseParameters noise = {};
};

// Poses whose numbers follow each other, joined by an EDGE_SE2 either way, are a robot's; its odometry is
// those edges (pose_controls.h). An EDGE_SE2_XY is an observation of the landmark whose number
// it has; at a distance of 0 a contact detection. Estimates (VERTEX_…) are not looked at but for their
// numbers, nor is an edge's information but for whether it can be one: positive semidefinite. Loops (EDGE_SE2
// between other poses) and edges of other kinds, for which a log has no place, are counted as left out.
// Throws InputError "FILE:LINE: REASON: DETAIL", that the graph is of three dimensions, that no two poses
// follow each other, or that they are of more than a thousand robots.
ImportReport ImportG2o(const G2oImportOptions& options, Blob* log);

}  // namespace cairn::datasets
