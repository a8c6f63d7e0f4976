// `cairn import tum`: trajectories from elsewhere, as a table of poses (schema/FORMAT.md, `poses`).
#pragma once

#include <string>
#include <vector>

#include "datasets/import/log_rows.h"
#include "schema/blob.h"

namespace cairn::datasets {

struct TumImportOptions {
  std::vector<std::string> files;   // one a robot, plain or gzipped
  std::vector<std::string> robots;  // their names; empty: those of the files, without their endings
  bool skip_bad = false;  // skip bad lines and count them by reason, instead of stopping at the first
};

// Lines of 'time x y z qx qy qz qw', as TUM's tools and evo write them, or of 'time x y heading' (radians);
// what begins with '#' is left out. Height and tilt are forgotten, with a warning where there is more than
// 0.5 m or 5 degrees of them. Bad are: not a number, not finite, other numbers of values, a quaternion that
// is none (length not 1 to 1%), a time that does not run forward.
// Throws InputError "FILE:LINE: REASON: DETAIL", or that a file has no pose, or two robots one name.
ImportReport ImportTum(const TumImportOptions& options, Blob* poses);

}  // namespace cairn::datasets
