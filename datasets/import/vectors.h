// `cairn import vectors`: what any sensor gave, with the poses at which it did. A file is a run, plain or
// gzipped, with a header; columns stand in any order:
//
//   time_s,x_m,y_m[,heading_rad]   of any clock, in order; of any frame, the same for all runs
//   odometry_turn_rad, odometry_forward_m[, odometry_left_m]
//                                  since the row before, first the turn; all of them or none
//   any other                      an input each, called by its column
#pragma once

#include <string>
#include <vector>

#include "datasets/import/log_rows.h"
#include "schema/blob.h"

namespace cairn::datasets {

struct VectorsImportOptions {
  std::vector<std::string> runs;  // files; a run is called after its own, without folder, .csv and .gz
  bool skip_bad = false;          // skip bad lines and count them by reason, instead of stopping at the first
};

// Makes `samples` (schema/FORMAT.md): inputs in the order of the first file. The report warns of samples that
// repeat a pose. Bad lines are: not a number, not finite, too large (for 32 bits), wrong number of columns,
// time runs backwards. Refused are also a file without inputs or with other columns than the first, an input
// without a name of its own, a run of less than two samples, two runs of one name, and skipped lines in a run
// with odometry, which would leave a gap in it.
// Throws InputError "FILE:LINE: REASON: DETAIL".
ImportReport ImportVectors(const VectorsImportOptions& options, Blob* samples);

}  // namespace cairn::datasets
