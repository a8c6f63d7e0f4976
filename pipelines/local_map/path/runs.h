// A robot's odometry, cut where it jumps and where nothing was sensed for long, and the scans of its sensors
// along it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pipelines/common/odometry.h"
#include "pipelines/common/range_scans.h"
#include "schema/blob.h"
#include "schema/geometry.h"
#include "schema/kinds/fields.h"

namespace cairn::local_map {

struct RunOptions {
  double jump_mps = 3;    // faster than this no robot drives
  double jump_radps = 4;  // or turns
  double gap_s = 30;      // without a scan for so long, grids begin anew
};

struct Cut {
  double time_s = 0;  // the last scan before
  std::string why;    // "jump", "gap"
};

// One moment at which one or several of a robot's rings were read.
struct Scan {
  double time_s = 0;
  Pose pose;             // dead reckoning without the jumps, from the robot's start; heading not wrapped
  double path_m = 0;     // distance travelled so far
  std::int32_t run = 0;  // which run of this robot
  bool jumped = false;   // odometry did, since the scan before
  bool slipped = false;  // since the scan before its way is that which scans show, and not odometry's
  bool unsure = false;   // amid a control that turns much, and does not say when
  static void Fields(const auto& field) {
    field("time_s", &Scan::time_s);
    field("pose", &Scan::pose);
    field("path_m", &Scan::path_m);
    field("run", &Scan::run);
    field("jumped", &Scan::jumped);
    field("slipped", &Scan::slipped);
    field("unsure", &Scan::unsure);
  }
};

struct RobotRuns {
  std::vector<std::size_t> sensors;  // of the log's, in the order of PosedScans
  std::vector<Scan> scans;
  std::vector<std::int64_t> row_of_log;  // [scans][sensors] the row of the log that holds it; -1: not read
  std::vector<Cut> cuts;
};

// Takes what one control says of the way out where it is more than a robot can do: `jumps` are the times of
// such controls' ends.
Odometry WithoutJumps(Odometry odometry, const RunOptions& options, std::vector<double>* jumps);

// Cut dead reckoning of all robots, as a table of poses (schema/FORMAT.md): what ReadRangeScans places scans
// by. `log` without odometry: its poses.
// Throws InputError that names the robot where it has neither odometry nor poses, its arrays are empty or
// differ in length, a number is not finite, or time runs backwards.
struct DeadReckoning {
  std::vector<Odometry> robots;
  std::vector<std::vector<double>> jumps;  // [robots]
  Blob poses;
};
DeadReckoning ReckonAll(const Blob& log, const RunOptions& options);

// Readings of one robot's sensors that are less than kTogether_s apart make one scan of all of them.
inline constexpr double kTogether_s = 0.02;
// Where a scan lies amid a control, that control's turn is spread over its time: rows of odometry may be a
// second apart, and robots do not turn at once.
std::vector<RobotRuns> CutRuns(const PosedScans& scans, const DeadReckoning& reckoning,
                               const RunOptions& options);

// The scans as arrays of a row each, so that a task may take some; RowsIn<Scan> reads them.
Blob RowsOf(const RobotRuns& runs);

}  // namespace cairn::local_map
