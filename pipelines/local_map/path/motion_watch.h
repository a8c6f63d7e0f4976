// Where a laser's scans show another motion of the robot than odometry does: wheels slip, encoders stand
// still, the robot is carried, or the recorder was paused.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "pipelines/local_map/path/runs.h"
#include "pipelines/local_map/path/scale_watch.h"
#include "pipelines/local_map/path/scan_motion.h"

namespace cairn::local_map {

// Two scans, some time apart, that odometry does not explain. Motions are in the robot's frame at `from`.
struct Contradiction {
  std::int32_t watch = 0;         // which of the watches, each of which looks over another time
  std::int64_t from = 0, to = 0;  // scans
  Pose seen, odometry;            // `seen` of a hole where they do not meet: odometry's
  bool hole = false;              // the scans before and after do not meet as odometry has them
  bool meets = false;             // a hole: they do where the robot moved as `seen`
  static void Fields(const auto& field) {
    field("watch", &Contradiction::watch);
    field("from", &Contradiction::from);
    field("to", &Contradiction::to);
    field("seen", &Contradiction::seen);
    field("odometry", &Contradiction::odometry);
    field("hole", &Contradiction::hole);
    field("meets", &Contradiction::meets);
  }
};

// Of enough beams to tell a motion by: no few infra-red sensors.
bool IsLaser(const ScaleWatch::Ring& ring);
// The laser that has the most beams; none where there is none.
std::optional<std::size_t> LaserOfMostBeams(const std::vector<ScaleWatch::Ring>& rings);

class MotionWatch {
 public:
  // Looks at the laser that has the most beams; at nothing where there is none.
  explicit MotionWatch(const std::vector<ScaleWatch::Ring>& rings);

  // Scan number `scan` at a pose of dead reckoning; `unsure`: which is not to be held against other scans;
  // `own`: what it contradicts is reported. A robot that is
  // carried while its scans go on is noticed a scan later, when two scans from either side tell the same.
  void Update(std::int64_t scan, double time_s, const Pose& pose, bool unsure, std::span<const RingScan> read,
              bool own);

  const std::vector<Contradiction>& found() const { return found_; }

 private:
  struct Seen {
    std::int64_t scan = -1;  // none yet
    double time_s = 0;
    Pose pose;
    LaserView view;
  };
  // Whether nothing was read for long before this scan; learns how long is usual.
  bool EndsHole(double time_s);
  void Compare(std::int32_t watch, const Seen& before, const Seen& now);
  void CompareOverHole(const Seen& before, const Seen& now);
  // Whether between the second and the third of the last four the robot was carried.
  void CompareOverStep();
  void ReportHole(const Seen& before, const Seen& now, const ScanMotion& near);

  std::size_t ring_ = 0;
  std::vector<LaserFan> fan_;  // none or one
  std::vector<Seen> before_;   // of each watch
  std::vector<Seen> last_;     // of the first watch, four at most, which no short hole parts
  double last_s_ = 0, usual_s_ = 0;
  Pose last_pose_;
  std::vector<Contradiction> found_;
};

// A stretch of time over which a path and the scans that it is made of tell of different motions.
struct Disagreement {
  double from_s = 0, until_s = 0;
  double scans_turn_rad = 0, odometry_turn_rad = 0, path_turn_rad = 0;  // summed over the stretch
  double apart_m = 0;           // by which the ways of the scans and of the path differ
  double odometry_apart_m = 0;  // and those of the scans and of odometry
  bool hole = false;
  std::vector<std::size_t> of;  // contradictions that say so
  static void Fields(const auto& field) {
    field("from_s", &Disagreement::from_s);
    field("until_s", &Disagreement::until_s);
    field("scans_turn_rad", &Disagreement::scans_turn_rad);
    field("odometry_turn_rad", &Disagreement::odometry_turn_rad);
    field("path_turn_rad", &Disagreement::path_turn_rad);
    field("apart_m", &Disagreement::apart_m);
    field("odometry_apart_m", &Disagreement::odometry_apart_m);
    field("hole", &Disagreement::hole);
  }
};

// Of what was found along dead reckoning, where odometry does not move as the scans show it, and where the
// path of `scans` does not move so. Contradictions that follow each other are one; those that are too little
// to harm a map, as where a clock is off, are left out. In order of time, none during another.
std::vector<Disagreement> Disagreements(const std::vector<Contradiction>& found,
                                        const std::vector<Scan>& scans);

// By how much more than odometry the robot has turned at each scan, as the scans show it where both disagree
// much; empty where they nowhere do. `scans` along dead reckoning.
std::vector<double> MissedTurns(const std::vector<Contradiction>& found, const std::vector<Scan>& scans);
// And how much further it has gone, in their frame; makes the scans of such ways `slipped`.
void MakeWaysGood(const std::vector<Contradiction>& found, std::vector<Scan>* scans);

}  // namespace cairn::local_map
