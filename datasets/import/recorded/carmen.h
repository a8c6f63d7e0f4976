// `cairn import carmen`: a log of CARMEN's logger, plain or gzipped, of old or new messages: ODOM, FLASER,
// RLASER, LASER3/4, RAWLASER1 to 5, ROBOTLASER1 to 5, SONAR, TRUEPOS, MARKER (or LANDMARK), PARAM.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "datasets/import/log_rows.h"
#include "schema/blob.h"
#include "schema/geometry.h"

namespace cairn::datasets {

struct CarmenImportOptions {
  // Whether the poses in the log are those of its odometry, or were mended by a program. Detected: mended
  // where the log has lines of such a program (NEFF), or where the pose of the laser does not go with that of
  // the robot.
  enum class Poses { kDetect, kCorrected, kRaw };
  std::string path;
  bool skip_bad = false;  // skip bad lines and count them by reason, instead of stopping at the first
  NoiseParameters noise;  // CARMEN states none
  Poses poses = Poses::kDetect;
  bool numbered = false;       // time is the line's number, not its stamp
  bool named_markers = false;  // markers of the same text are at the same landmark
  // Of messages that do not say it themselves (FLASER, RLASER, LASER3, LASER4), else by PARAM, else by the
  // number of beams n: 180/n degrees for 180 and 360, 0.25 for 400 and 401, else 180/(n - 1).
  std::optional<double> first_deg, step_deg;
  // Else as the message says, as PARAM says, 50 m; sonars 5 m. Where neither says it, one reading that fills
  // up the log (common/range_doubts.h).
  std::optional<double> max_range_m, sonar_max_range_m;
  std::map<std::string, Pose> mounts;  // where a laser sits on the robot, for "laser", "laser2", …
};

// Writes a `log` (schema/FORMAT.md) of one robot: lasers as `laser` (in front), `laser2` (at the rear) to
// `laser5`, sonars as `sonar`, markers as contact detections. A laser sits where its messages say (the median
// of the laser's pose as seen from the robot's); those without poses, or with the same one for both at the
// rear, where PARAM says, the rear one looking back. RAWLASERn is left out where ROBOTLASERn (or FLASER,
// RLASER) holds the same. Odometry, or what takes its place, gives the controls; corrected poses become the
// pose table, in which each scan finds its own pose at its time (datasets/import/recorded/range_log.h). Bad
// are: an unknown message, not a number, not finite, fewer or more values than declared, a negative range,
// one of more than 1000 m, a laser without a resolution or a maximum range above 0, beams or geometry other
// than those of the sensor's first scan, time that runs backwards by more than a second. Ranges at or beyond
// the sensor's reach, and of 0, are no bad lines: 'nothing' is told so. Throws InputError "FILE:LINE: REASON:
// DETAIL".
ImportReport ImportCarmen(const CarmenImportOptions& options, Blob* log);

}  // namespace cairn::datasets
