// What is taken from the messages of one topic, by the kind of use.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "datasets/bag/frames.h"
#include "datasets/bag/message_reader.h"
#include "datasets/bag/topics.h"
#include "datasets/common/fields.h"
#include "datasets/import/recorded/range_log.h"
#include "schema/store/spooled_rows.h"

namespace cairn::datasets::bag {

// Which time a message counts at, and what is known of the clock by which its header was written.
struct ClockOptions {
  bool by_receipt = false;  // by the recorder's clock, not by the header
  double from_s = -std::numeric_limits<double>::infinity(), until_s = std::numeric_limits<double>::infinity();
};

inline constexpr char kRunsBackwards[] = "time runs backwards";

class TopicClock {
 public:
  explicit TopicClock(const ClockOptions& options) : options_(options) {}
  // Nothing where the message is before --from or after --until. `header`: the stamp's numbers; empty where
  // the message has none. Throws LineError: the stamp is zero, more than a second behind one before it, or
  // leaps ahead by a minute and more, where before it went on as the recorder's clock does.
  std::optional<double> At(const std::vector<double>& header, std::int64_t receive_ns);
  // The same of a time that was looked at already.
  std::optional<double> WithinPath(double time_s) const;
  // Of a transform, which may be of any time.
  double TransformTime(double header_s, std::int64_t receive_ns) const;
  // By how much the recorder's clock is ahead of the header's, or a message underway, at the least; nothing
  // where no header was looked at.
  std::optional<double> least_delay_s() const { return least_delay_s_; }

 private:
  bool Leaps(double time_s, double received_s) const;

  const ClockOptions& options_;
  std::int64_t taken_ = 0;
  double first_s_ = 0, first_received_s_ = 0, latest_received_s_ = 0;
  double latest_s_ = -std::numeric_limits<double>::infinity();
  std::optional<double> least_delay_s_;
};

// What a sensor with one beam said.
struct ConeReading {
  double time_s = 0;
  std::size_t number = 0;
  double range_m = 0;
};

// When a scan was made, and in which message it came.
struct ScanTime {
  double time_s = 0;
  std::size_t number = 0;
};

// Scans of one topic before it is known where its sensor sits.
struct ScanTopic {
  std::string topic, frame;
  double first_rad = 0, step_rad = 0;  // of its beams
  double opening_rad = 0, max_range_m = 0;
  bool is_infrared = false;
  std::size_t beams = 0;
  std::filesystem::path folder;  // for its scans (ScanRows)
  ScanRows scans;                // of a laser: a row for each time
  SpooledRows<ScanTime> times;
  SpooledRows<ConeReading> cones;  // or these
  // Of clouds: beams are as the robot has them, about this place; and how many scans had points there.
  std::optional<Pose> level_at;
  std::vector<std::size_t> scans_with_points;
};

// A marker that was seen, before it is known where the camera sits.
struct Sighting {
  double time_s = 0;
  std::size_t number = 0;
  std::string name;    // empty: not known
  PointInSpace point;  // in `frame`
  std::string frame;
  bool is_contact = false;  // the robot is at it: there is no point
};

// The place of a frame in tf whose name is that of a landmark, or a detection that stands for one.
struct FrameSighting {
  double stamp_s = 0;  // by the header
  Sighting seen;
};

// Which frames of tf are landmarks, and where they were.
struct FollowedFrames {
  std::vector<std::string> beginnings;  // of their names
  std::vector<FrameSighting> seen;
  bool with_tags = false;  // those of apriltag_ros too, as "tag36h11:7"
  std::vector<FrameSighting> tags;
};

// A pose of a topic, in the order of messages.
struct PoseRow {
  double time_s = 0;
  std::size_t number = 0;
  Pose pose;
};

// 0, or nothing, where there is none.
inline double FirstNumber(const Found& found) { return found.numbers.empty() ? 0 : found.numbers.front(); }
// Throws LineError where a definition says that it may be of another kind, and it is.
inline std::size_t CountOf(double number) {
  if (!(number >= 0 && number < 4294967296.0 && number == std::floor(number)))
    throw LineError{"no number of elements or bytes", std::to_string(number)};
  return static_cast<std::size_t>(number);
}
inline std::size_t FirstCount(const Found& found) { return CountOf(FirstNumber(found)); }
inline std::string FirstText(const Found& found) {
  return found.texts.empty() ? std::string() : std::string(found.texts.front());
}

class TopicReader {
 public:
  virtual ~TopicReader() = default;
  // Those that are needed first.
  virtual std::vector<std::string> paths() const = 0;
  virtual std::size_t needed() const = 0;
  // Whether somebody named the paths: then there is no doing without them.
  virtual bool fields_are_named() const { return false; }
  // Whether nothing of it comes into the log: what is bad of it does not matter.
  virtual bool is_aside() const { return false; }
  // Throws LineError where the message cannot be used.
  virtual void Take(const std::vector<Found>& found, const Message& message, TopicClock* clock) = 0;
};

// A step on: ahead and to the left of the heading in its middle.
inline Pose Moved(const Pose& from, double ahead_m, double aside_m, double turn_rad) {
  Pose pose = Compose(Compose(from, {0, 0, turn_rad / 2}), {ahead_m, aside_m, turn_rad / 2});
  pose.heading_rad = WrapAngle(pose.heading_rad);
  return pose;
}

// Of kOdometry; `frame`, `base`: those of its first message.
struct OdometryRows {
  SpooledRows<PoseRow> poses;
  std::string frame, base;
  std::vector<std::string> other_joints;  // of messages without the wheels that were asked for
  bool has_covariances = false;
  // Variances of the heading that its first and last messages state.
  double first_variance = 0, last_variance = 0;
};
std::unique_ptr<TopicReader> ReadOdometry(OdometryRows* rows, bool is_aside = false);
// Of kVelocity: poses that follow from it, each velocity holding until the next one.
std::unique_ptr<TopicReader> ReadVelocity(const std::string& type, OdometryRows* rows);
// What a robot has of them.
struct TransformsOf {
  FrameTree* frames = nullptr;
  FollowedFrames* followed = nullptr;
};
// For each of the robots. `are_static`: they hold at all times, and are no sightings.
std::unique_ptr<TopicReader> ReadTransforms(bool are_static, std::vector<TransformsOf> robots);
// Of kScan and kCone.
std::unique_ptr<TopicReader> ReadScans(const std::string& type, ScanTopic* topic);
// Of kPose and kOdometry; of a path that grows from message to message its last state counts.
std::unique_ptr<TopicReader> ReadPoses(const std::string& type, SpooledRows<PoseRow>* rows);

}  // namespace cairn::datasets::bag
