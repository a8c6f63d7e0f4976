// The range scans of a log, each with the pose of its robot: what occupancy maps are made of.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pipelines/common/grid_box.h"
#include "pipelines/common/options.h"
#include "schema/blob.h"
#include "schema/geometry.h"

namespace cairn {

// One sensor of one robot, all its scans (schema/FORMAT.md, range scans).
struct RangeScans {
  std::string name;                    // "robot/0/sonar/", as in the log
  std::vector<Pose> beams;             // [B] where each beam begins and points, on the robot
  std::vector<double> turret_rad;      // [S] by which the beams were turned about its origin; empty: not
  double opening_rad = 0;              // of a beam's cone; 0: a ray
  double max_range_m = 0;              // its reach
  std::vector<double> time_s;          // [S]
  std::vector<Pose> pose;              // [S] of the robot
  std::vector<std::uint8_t> held_out;  // [S] 1: kept for evaluation, not for the map
  std::vector<std::uint8_t> checked;   // [S] 1: a map of the others is checked with it (checked_readings.h)
  std::vector<std::int64_t> row;       // [S] which of the log's scans
  Array range_m;                       // [S,B] f64, below the reach; NaN: nothing within it, or no answer

  std::size_t scans() const { return time_s.size(); }
  // Of what carries the beams.
  Pose MountPose(std::size_t scan) const {
    Pose mount = pose[scan];
    if (!turret_rad.empty()) mount.heading_rad += turret_rad[scan];
    return mount;
  }
  Pose BeamPose(std::size_t scan, std::size_t beam) const { return Compose(MountPose(scan), beams[beam]); }
};

// What the pipelines of grid maps have in common: which scans, at which poses, on which grid.
struct GridOptions {
  double cell_m = 0.05;
  std::string box_m;    // empty: all that the scans tell of
  std::string sensors;  // empty: all
  std::string robots;   // empty: all
  double heldout = 0;
  double pose_gap_s = 0;
  bool skip_unposed = false;
  std::int64_t memory_mb = 2048;
};

template <class V>
void VisitGridOptions(V& visit, GridOptions& o) {
  visit(Option{"cell_m", "m", 0.001, 100, "edge of a cell"}, o.cell_m);
  visit(
      Option{
          "box_m", "m", 0, 0,
          "lower left and upper right corner of the map, 'x0,y0,x1,y1'; empty: as far as obstacles were met"},
      o.box_m);
  visit(Option{"sensors", "", 0, 0,
               "of which sensors, by commas: sonar, infrared, laser, laser2 to laser5; empty: all"},
        o.sensors);
  visit(Option{"robots", "", 0, 0, "whose scans, by commas: names of the log's robots; empty: all"},
        o.robots);
  visit(Option{"heldout", "", 0, 0.9,
               "share of the scans left out of the map, the last part of each tenth of the log, so that "
               "`cairn evaluate` can score it with them"},
        o.heldout);
  visit(Option{"pose_gap_s", "s", 0, 1e9,
               "poses further apart say nothing of the time between them; 0: any two do"},
        o.pose_gap_s);
  visit(
      Option{"skip_unposed", "", 0, 0, "leave out scans of times without poses; otherwise they are an error"},
      o.skip_unposed);
  visit(Option{"memory_mb", "MiB", 1, 1e6, "a task may take; a map that needs more is refused"}, o.memory_mb);
}

// The sensors of the robots in the order of robots, then sonar and infra-red before lasers, as `options`
// choose both. Poses come from `poses` (its robot/N/poses/, by the robot's name), else from the log's own,
// else from dead reckoning; `poses` may be null. Between two of them a robot moves as its odometry says, with
// the difference spread evenly over time, or straight where there is none. The log was checked as its kind.
// Throws InputError where `poses` is a result that was made from another log.
// Throws InputError that names sensor and scan where
// - there are no scans, or none with a pose; an option names a sensor that there can not be, or a robot that
//   the log does not have;
// - a range is beyond the sensor's reach, or its opening is half a turn or more;
// - there is no pose for a time and `skip_unposed` is false.
struct PosedScans {
  std::vector<RangeScans> sensors;
  std::vector<std::string> robots;  // whose they are
  std::vector<std::string>
      own_frames;           // those of them whose poses lie in a frame of their own (pose_track.h)
  std::size_t unposed = 0;  // scans left out
};
PosedScans ReadRangeScans(const Blob& log, const Blob* poses, const GridOptions& options);
// The same of a log's head, which has no ranges, only their shape (Inputs::GetHead, kRanges): tasks read
// these, and check them (ScansOf). `source`: the log's SourceHash.
PosedScans ReadScanHeads(const Blob& head, const Hash& source, const Blob* poses, const GridOptions& options);
inline constexpr char kRanges[] = "range_m";

// That memory_mb allows.
double MostCells(const GridOptions& options, double bytes_per_cell);

// The grid of `options`, or one that holds all poses and all that was met, with a margin of 0.5 m, at most
// `bytes_per_cell` of memory_mb.
// Throws InputError where the scans are of several robots whose poses lie in no common frame.
// Throws InputError where box_m does not hold all poses.
// Throws InputError where the grid would need more than memory_mb.
GridBox GridOf(const PosedScans& scans, const GridOptions& options, double bytes_per_cell);
// In steps, where ranges are read elsewhere: where the robots were, or box_m, which holds that; all that
// beams met of scans that are not held out; and the grid of both.
Extent FrameOf(const PosedScans& scans, const GridOptions& options);
Extent EndsOf(const RangeScans& scans);
GridBox GridOf(Extent frame, const Extent& ends, const GridOptions& options, double bytes_per_cell);

// What a grid_map says of its making: robots and log_hash, and NAME/time_s, x_m, y_m, heading_rad (of the
// robot at each scan), held_out. `log` may be a head, of which `source` is the log's SourceHash.
void PutScanPoses(const PosedScans& scans, const Blob& log, const Hash& source, Blob* result);
inline void PutScanPoses(const PosedScans& scans, const Blob& log, Blob* result) {
  PutScanPoses(scans, log, log.SourceHash(), result);
}

// For tasks: a sensor without its scans; what is known of its scans but their ranges, as arrays of S rows, so
// that a task may take some; and the scans of these, whose ranges are read from the log itself, which is not
// copied, or from what has its rows from `first_row` on.
// ScansOf throws InputError where these do not fit each other, or name rows that the log lacks.
Blob SensorBlob(const RangeScans& sensor);
Blob ScansBlob(const RangeScans& sensor);
RangeScans SensorIn(const Blob& sensor);  // without scans
RangeScans ScansOf(const Blob& sensor, const Blob& scans, const Blob& log, std::int64_t first_row = 0);

}  // namespace cairn
