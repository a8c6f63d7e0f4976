// A log while it is read, and what importers have in common.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <vector>

#include "datasets/import/scan_rows.h"
#include "schema/blob.h"
#include "schema/geometry.h"
#include "schema/store/spooled_rows.h"

namespace cairn::datasets {

// Noise parameters of a robot and its sensor, as a data sheet gives them; schema/FORMAT.md, `noise/` and
// `sensor/`. What is missing is left to the pipeline.
struct NoiseParameters {
  std::optional<double> heading_drift_rad_per_m;
  std::optional<double> heading_walk_rad_per_sqrt_m;
  std::optional<double> forward_ratio;
  std::optional<double> turn_ratio;
  std::optional<double> contact_m;
  std::optional<double> range_m;
  std::optional<double> bearing_rad;
  std::optional<double> false_ratio;
  std::optional<double> miss_ratio;
  std::optional<double> max_range_m;
  std::optional<double> field_of_view_rad;
};

// The sensor that sees the landmarks, where its readings are not of the robot's own frame and of its
// odometry's clock.
struct LandmarkSensor {
  Pose mount;         // on the robot
  double late_s = 0;  // its times are so much too late

  void ToRobotFrame(double* range_m, double* bearing_rad) const;
  // How far it reaches from the robot's own place, and what it sees, ahead of the robot, at the most.
  NoiseParameters OnRobot(NoiseParameters noise) const;
};

// What was taken in, and what was not.
struct ImportReport {
  std::int64_t robots = 0;
  std::int64_t controls = 0;
  std::int64_t observations = 0;  // contact detections among them
  std::int64_t contacts = 0;
  std::int64_t robot_observations = 0;
  std::int64_t landmarks = 0;                   // with identities
  std::int64_t scans = 0;                       // of range sensors
  std::map<std::string, std::int64_t> read;     // what was taken in, by kind; importers of one kind say none
  std::map<std::string, std::int64_t> skipped;  // bad lines, by reason; only with skip_bad
  std::map<std::string, std::int64_t> dropped;  // good lines that no log has a place for, by reason
  std::vector<std::string> warnings;
  // What no robot does (common/unit_doubts.h): whoever reads it in shall look.
  std::vector<std::string> unit_doubts;
};

// The file and the lines that rows come from, for messages; importers that do not keep it leave it empty.
struct Origin {
  std::string file;
  SpooledRows<std::size_t> line;  // of each row
  std::string before_line = ":";
  std::string Of(std::size_t row) const;  // "odometry.csv:7: ", or nothing
};

// Angles as they were read: the log has them within a turn. Columns as in schema/FORMAT.md; where a folder is
// named those of many rows lie there.
struct Odometry {
  SpooledRows<double> time_s, turn_rad, forward_m;
  Origin from;
  Odometry() = default;
  explicit Odometry(const std::filesystem::path& folder)
      : time_s(folder), turn_rad(folder), forward_m(folder) {}
  void Add(double time, double turn, double forward);
};
struct Observations {
  std::vector<double> time_s, range_m, bearing_rad;
  std::vector<std::int32_t> landmark;        // of an observation of a robot: which one
  std::vector<std::int32_t> truth_landmark;  // empty: there is no truth
  Origin from;
  void Add(double time, std::int32_t which, double range, double bearing);
};
struct Poses {
  SpooledRows<double> time_s, x_m, y_m, heading_rad;
  Origin from;
  Poses() = default;
  explicit Poses(const std::filesystem::path& folder)
      : time_s(folder), x_m(folder), y_m(folder), heading_rad(folder) {
    from.line = SpooledRows<std::size_t>(folder);
  }
  void Add(double time, double x, double y, double heading, std::size_t line);
  void RemoveLast();
};
// Aligned as arrays are, and so made one without a copy.
template <class T>
struct ArrayAllocator {
  using value_type = T;
  static constexpr std::align_val_t kAlignment{64};
  ArrayAllocator() = default;
  template <class U>
  explicit ArrayAllocator(const ArrayAllocator<U>&) {}
  T* allocate(std::size_t count) { return static_cast<T*>(::operator new(count * sizeof(T), kAlignment)); }
  void deallocate(T* data, std::size_t) { ::operator delete(data, kAlignment); }
  friend bool operator==(const ArrayAllocator&, const ArrayAllocator&) { return true; }
};
using RangeValues = std::vector<double, ArrayAllocator<double>>;

// A range sensor on its robot, and its scans.
struct RangeRows {
  std::string sensor;  // "laser", "laser2", "sonar"
  std::vector<double> beam_x_m, beam_y_m, beam_heading_rad;
  double opening_rad = 0, max_range_m = 0;
  bool reach_is_assumed = false;  // max_range_m is a usual one: neither the log nor the user states any
  SpooledRows<double> time_s;
  RangeValues range_m;           // a row of all beams for each scan
  std::vector<float> intensity;  // the same; empty: the sensor does not say
  // Or, of a laser whose scans are its rows (RangeEvent::row): these, and which of their beams count (empty:
  // all); and what the log takes of them.
  std::shared_ptr<ScanRows> scans;
  std::vector<bool> beams_kept;
  std::optional<ScanRows::Taken> taken;
};
struct RobotRows {
  std::string name;
  Odometry odometry;
  Poses odometry_poses;  // that the odometry was made of, for unit_doubts; empty: it was not made of poses
  Poses poses;           // as the log's maker mended them; empty: there are none
  std::vector<RangeRows> ranges;
  Observations observations;
  Observations robot_observations;  // of other robots
  Poses truth;
};
struct TruthLandmarks {
  std::vector<std::string> name;
  std::vector<double> x_m, y_m;
};
struct LogRows {
  std::vector<RobotRows> robots;
  std::vector<std::string> landmarks;
  std::optional<TruthLandmarks> truth_landmarks;
  NoiseParameters noise;
};

// Velocities, each of which holds until the next one's time, as controls. An interval's way lies along the
// heading in its middle: half of its turn comes before the way and half after it, so an interval that does
// both becomes two rows of the same time, (turn/2, forward) and (turn/2, 0). The first velocity begins the
// log with an empty control.
class VelocityIntegrator {
 public:
  // `time` may repeat (the later velocity then counts) but not run backwards.
  void Add(double time_s, double v_mps, double omega_radps, Odometry* odometry);
  double largest_gap_s() const { return largest_gap_s_; }

 private:
  bool begun_ = false;
  double time_s_ = 0, v_mps_ = 0, omega_radps_ = 0, largest_gap_s_ = 0;
};

// Throws InputError that names the figure, and what is allowed, where one is negative or not finite; where
// a share is above one, the sensor's range is zero, or its field of view is zero or more than a full turn.
void CheckNoise(const NoiseParameters& noise);

// Why no such sensor can have measured this, as the reason and the detail of a bad line.
struct Misreading {
  std::string reason, detail;
};
// Nothing where it can. `bearing_rad` as it was read.
std::optional<Misreading> FindMisreading(double range_m, double bearing_rad, const NoiseParameters& noise);

// Puts `prefix`time_s, x_m, y_m, heading_rad; headings within a turn.
void PutPoses(const std::string& prefix, Poses poses, Blob* blob);

// What of the poses no robot does, into the report. `who`: "robot 'anna'"; `table`: "true poses".
void DoubtPosesOf(const Poses& poses, const std::string& who, const std::string& table, ImportReport* report);

// The blob of a log. `source`: what it was read from, for messages. Fills in the report's counts, its doubts
// about units, and its warnings: nothing was observed, holes in the odometry (schema/kinds/odometry_holes.h),
// doubts about observations (common/observation_doubts.h).
// Throws InputError for a log without controls.
Blob MakeLog(LogRows rows, const std::string& source, ImportReport* report);

// Wraps into (-pi, pi]; a value that lies there stays as it is to the bit.
double NormalizedAngle(double angle_rad);

}  // namespace cairn::datasets
