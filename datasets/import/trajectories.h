// `cairn import tum`, `kitti`, `euroc`: trajectories from elsewhere, as a table of poses (schema/FORMAT.md,
// `poses`).
#pragma once

#include <string>
#include <vector>

#include "datasets/import/log_rows.h"
#include "schema/blob.h"

namespace cairn::datasets {

struct TrajectoryImportOptions {
  std::vector<std::string> files = {};   // one a robot, plain or gzipped
  std::vector<std::string> robots = {};  // their names; empty: those of the files, without their endings
  bool skip_bad = false;  // skip bad lines and count them by reason, instead of stopping at the first
  enum class Format { kTum, kKitti, kEuroc };
  Format format = Format::kTum;
  // KITTI's have no times: files of them, one for each, a line a pose.
  std::vector<std::string> times = {};
  // KITTI's own are a camera's: x to the right, y down, z ahead. Else z is up.
  bool camera_axes = false;
};

// TUM's are lines of 'time x y z qx qy qz qw', as its tools and evo write them, or of 'time x y heading'
// (radians); KITTI's the upper three rows of each pose's matrix, a line of 12 numbers; EuRoC's CSV of
// nanoseconds, x, y, z, qw, qx, qy, qz, and more that is not looked at. What begins with '#' is left out.
// Height and tilt are forgotten, with a warning where there is more than 0.5 m or 5 degrees of them. Bad are:
// not a number, not finite, other numbers of values, a quaternion or a rotation that is none (lengths not 1
// to 1%), a time that does not run forward. Throws InputError "FILE:LINE: REASON: DETAIL", or that a file has
// no pose, or two robots one name, or that a file has other poses than times.
ImportReport ImportTrajectories(const TrajectoryImportOptions& options, Blob* poses);

}  // namespace cairn::datasets
