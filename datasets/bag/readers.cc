#include "datasets/bag/readers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "schema/text.h"

namespace cairn::datasets::bag {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

double OneOf(const Found& found) { return found.numbers.empty() ? 0 : found.numbers.front(); }
std::string TextIn(const Found& found) {
  return found.texts.empty() ? std::string() : std::string(found.texts.front());
}

// Seven paths of a pose below `at`, in the order of MakeTransform.
std::vector<std::string> PosePaths(const std::string& at, const std::string& position,
                                   const std::string& rotation) {
  std::vector<std::string> paths;
  for (const char* axis : {"x", "y", "z"}) paths.push_back(at + position + "." + axis);
  for (const char* axis : {"x", "y", "z", "w"}) paths.push_back(at + rotation + "." + axis);
  return paths;
}
constexpr std::size_t kPosePaths = 7;

// The element's of those paths, of which the first is `path`.
Transform TransformIn(const std::vector<Found>& found, std::size_t path, std::size_t element) {
  std::array<double, kPosePaths> n{};
  for (std::size_t i = 0; i < n.size(); ++i) {
    const std::vector<double>& numbers = found[path + i].numbers;
    if (element >= numbers.size()) throw LineError{"a pose without all of its numbers", ""};
    n[i] = numbers[element];
  }
  const auto transform = MakeTransform(n[0], n[1], n[2], n[3], n[4], n[5], n[6]);
  if (transform) return *transform;
  throw LineError{"no pose", "position " + std::to_string(n[0]) + " " + std::to_string(n[1]) + " " +
                                 std::to_string(n[2]) + ", rotation " + std::to_string(n[3]) + " " +
                                 std::to_string(n[4]) + " " + std::to_string(n[5]) + " " +
                                 std::to_string(n[6])};
}

class OdometryReader : public TopicReader {
 public:
  explicit OdometryReader(OdometryRows* rows) : rows_(*rows) {}
  std::vector<std::string> paths() const override {
    std::vector<std::string> paths = PosePaths("pose.pose.", "position", "orientation");
    for (const char* path : {"header.stamp", "header.frame_id", "child_frame_id", "pose.covariance"})
      paths.emplace_back(path);
    return paths;
  }
  std::size_t needed() const override { return kPosePaths + 1; }
  void Take(const std::vector<Found>& found, const Message& message, TopicClock* clock) override {
    const Transform pose = TransformIn(found, 0, 0);
    const auto time_s = clock->At(found[kPosePaths].numbers, message.receive_ns);
    if (!time_s) return;
    constexpr std::size_t kYaw = 35, kVariances = 36;
    const std::vector<double>& covariance = found[kPosePaths + 3].numbers;
    const double variance = covariance.size() == kVariances ? covariance[kYaw] : 0;
    if (rows_.poses.empty()) {
      rows_.frame = FrameName(TextIn(found[kPosePaths + 1]));
      rows_.base = FrameName(TextIn(found[kPosePaths + 2]));
      rows_.first_variance = variance;
    }
    rows_.last_variance = variance;
    rows_.poses.push_back({*time_s, message.number, pose.Planar()});
  }

 private:
  OdometryRows& rows_;
};

class VelocityReader : public TopicReader {
 public:
  VelocityReader(const std::string& type, OdometryRows* rows) : rows_(*rows) {
    if (type == "geometry_msgs/TwistStamped") at_ = "twist.";
    if (type == "geometry_msgs/TwistWithCovarianceStamped") at_ = "twist.twist.";
  }
  std::vector<std::string> paths() const override {
    return {at_ + "linear.x", at_ + "linear.y", at_ + "angular.z", "header.stamp"};
  }
  std::size_t needed() const override { return at_.empty() ? 3 : 4; }
  void Take(const std::vector<Found>& found, const Message& message, TopicClock* clock) override {
    constexpr double kMost = 1e3;
    const double ahead = OneOf(found[0]), aside = OneOf(found[1]), turn = OneOf(found[2]);
    if (!(std::abs(ahead) < kMost && std::abs(aside) < kMost && std::abs(turn) < kMost))
      throw LineError{"no velocity", std::to_string(ahead) + " " + std::to_string(aside) + " m/s, " +
                                         std::to_string(turn) + " rad/s"};
    const auto time_s = clock->At(found[3].numbers, message.receive_ns);
    if (!time_s || (!rows_.poses.empty() && *time_s < rows_.poses.back().time_s)) return;
    Pose pose;
    if (!rows_.poses.empty()) {
      const double seconds = *time_s - rows_.poses.back().time_s;
      const double half = turn_ * seconds / 2;
      // The way lies along the heading in the middle of the interval.
      pose = Compose(rows_.poses.back().pose, {0, 0, half});
      pose = Compose(pose, {ahead_ * seconds, aside_ * seconds, half});
      pose.heading_rad = WrapAngle(pose.heading_rad);
    }
    rows_.poses.push_back({*time_s, message.number, pose});
    ahead_ = ahead;
    aside_ = aside;
    turn_ = turn;
  }

 private:
  OdometryRows& rows_;
  std::string at_;
  double ahead_ = 0, aside_ = 0, turn_ = 0;
};

class TransformReader : public TopicReader {
 public:
  explicit TransformReader(FrameTree* frames) : frames_(*frames) {}
  std::vector<std::string> paths() const override {
    std::vector<std::string> paths = PosePaths("transforms.transform.", "translation", "rotation");
    for (const char* path :
         {"transforms.header.stamp", "transforms.header.frame_id", "transforms.child_frame_id"})
      paths.emplace_back(path);
    return paths;
  }
  std::size_t needed() const override { return kPosePaths + 3; }
  void Take(const std::vector<Found>& found, const Message& message, TopicClock* clock) override {
    const std::vector<std::string_view>&parents = found[kPosePaths + 1].texts,
          &children = found[kPosePaths + 2].texts;
    const std::vector<double>& stamps = found[kPosePaths].numbers;
    for (std::size_t i = 0; i < std::min({stamps.size(), parents.size(), children.size()}); ++i) {
      const Transform transform = TransformIn(found, 0, i);
      // A static transform holds at all times, and may have none.
      const double stamp_s = clock->TransformTime(stamps[i], message.receive_ns);
      frames_.Add(FrameName(parents[i]), FrameName(children[i]), stamp_s, transform);
    }
  }

 private:
  FrameTree& frames_;
};

class ScanReader : public TopicReader {
 public:
  ScanReader(bool has_echoes, ScanTopic* topic) : has_echoes_(has_echoes), topic_(*topic) {}
  std::vector<std::string> paths() const override {
    return {has_echoes_ ? "ranges.echoes" : "ranges",
            "angle_min",
            "angle_increment",
            "range_max",
            "header.stamp",
            "range_min",
            "header.frame_id",
            "ranges"};
  }
  std::size_t needed() const override { return 5; }
  void Take(const std::vector<Found>& found, const Message& message, TopicClock* clock) override {
    const std::vector<double>& ranges = found[0].numbers;
    const double first = OneOf(found[1]), step = OneOf(found[2]), reach = OneOf(found[3]);
    const auto time_s = clock->At(found[4].numbers, message.receive_ns);
    if (!time_s) return;
    if (has_echoes_ && OneOf(found[7]) != static_cast<double>(ranges.size()))
      throw LineError{"beams of other than one echo", "take the topic of first echoes as LaserScan"};
    if (topic_.events.empty() && topic_.beams == 0) Begin(first, step, reach, ranges.size(), found[6]);
    if (ranges.size() != topic_.beams)
      throw LineError{"other beams than the topic's first scan",
                      std::to_string(ranges.size()) + " instead of " + std::to_string(topic_.beams)};
    constexpr double kSame = 1e-4;
    if (!(std::abs(first - topic_.first_rad) < kSame && std::abs(step - topic_.step_rad) < kSame))
      throw LineError{"other geometry than the topic's first scan", "its start angle or increment changed"};
    RangeEvent event;
    event.line = message.number;
    event.stamp_s = *time_s;
    event.range_m = ranges;
    // REP 117: nearer than the least range is no reading, NaN none, infinity nothing within reach.
    const double least = OneOf(found[5]);
    for (double& range : event.range_m)
      if (!(range >= least)) range = kNone;
    topic_.events.push_back(std::move(event));
  }

 private:
  void Begin(double first, double step, double reach, std::size_t beams, const Found& frame) {
    constexpr double kMostTurns = 7;
    constexpr std::size_t kMostBeams = 100'000;
    const double last = first + step * static_cast<double>(beams);
    if (!(std::abs(first) < kMostTurns && std::abs(last) < 2 * kMostTurns) || step == 0)
      throw LineError{"no fan of beams", "from " + std::to_string(first) + " rad by " + std::to_string(step)};
    if (beams == 0 || beams > kMostBeams) throw LineError{"no scan", std::to_string(beams) + " beams"};
    if (!(reach > 0 && reach <= 1e4))
      throw LineError{"no reach", "range_max " + std::to_string(reach) + " m"};
    topic_.frame = FrameName(TextIn(frame));
    topic_.first_rad = first;
    topic_.step_rad = step;
    topic_.max_range_m = reach;
    topic_.beams = beams;
  }

  bool has_echoes_;
  ScanTopic& topic_;
};

class ConeReader : public TopicReader {
 public:
  explicit ConeReader(ScanTopic* topic) : topic_(*topic) {}
  std::vector<std::string> paths() const override {
    return {"range",        "max_range", "field_of_view",  "radiation_type",
            "header.stamp", "min_range", "header.frame_id"};
  }
  std::size_t needed() const override { return 5; }
  void Take(const std::vector<Found>& found, const Message& message, TopicClock* clock) override {
    const double reach = OneOf(found[1]), opening = OneOf(found[2]);
    const auto time_s = clock->At(found[4].numbers, message.receive_ns);
    if (!time_s) return;
    if (topic_.beams == 0) {
      if (!(reach > 0 && reach <= 1e4))
        throw LineError{"no reach", "max_range " + std::to_string(reach) + " m"};
      if (!(opening >= 0 && opening < 7))
        throw LineError{"no cone", "field_of_view " + std::to_string(opening) + " rad"};
      topic_.frame = FrameName(TextIn(found[6]));
      topic_.max_range_m = reach;
      topic_.opening_rad = opening;
      topic_.is_infrared = OneOf(found[3]) == 1;
      topic_.beams = 1;
    }
    RangeEvent event;
    event.line = message.number;
    event.stamp_s = *time_s;
    const double range = OneOf(found[0]);
    event.range_m = {range >= OneOf(found[5]) ? range : kNone};
    topic_.events.push_back(std::move(event));
  }

 private:
  ScanTopic& topic_;
};

class PoseReader : public TopicReader {
 public:
  PoseReader(const std::string& type, std::vector<PoseRow>* rows) : rows_(*rows) {
    is_path_ = type == "nav_msgs/Path";
    is_transform_ = type == "geometry_msgs/TransformStamped";
    if (type == "geometry_msgs/PoseWithCovarianceStamped" || type == "nav_msgs/Odometry") at_ = "pose.pose.";
    if (is_path_) at_ = "poses.pose.";
    if (is_transform_) at_ = "transform.";
  }
  std::vector<std::string> paths() const override {
    std::vector<std::string> paths = PosePaths(at_, is_transform_ ? "translation" : "position",
                                               is_transform_ ? "rotation" : "orientation");
    paths.emplace_back(is_path_ ? "poses.header.stamp" : "header.stamp");
    return paths;
  }
  std::size_t needed() const override { return kPosePaths + 1; }
  void Take(const std::vector<Found>& found, const Message& message, TopicClock* clock) override {
    const std::vector<double>& stamps = found[kPosePaths].numbers;
    if (!is_path_) {
      const Transform pose = TransformIn(found, 0, 0);
      if (const auto time_s = clock->At(stamps, message.receive_ns))
        rows_.push_back({*time_s, message.number, pose.Planar()});
      return;
    }
    std::vector<PoseRow> rows;
    for (std::size_t i = 0; i < stamps.size(); ++i) {
      const Transform pose = TransformIn(found, 0, i);
      if (i > 0 && !(stamps[i] >= stamps[i - 1])) throw LineError{"time runs backwards", "within a path"};
      if (const auto time_s = clock->WithinPath(stamps[i]))
        rows.push_back({*time_s, message.number, pose.Planar()});
    }
    if (rows.size() >= rows_.size()) rows_ = std::move(rows);
  }

 private:
  std::vector<PoseRow>& rows_;
  std::string at_ = "pose.";
  bool is_path_ = false, is_transform_ = false;
};

// Where a type of detections has what it says of each.
struct MarkerType {
  std::string_view type, each, id, position;
};
constexpr MarkerType kMarkerTypes[] = {
    {"apriltag_ros/AprilTagDetectionArray", "detections", "detections.id",
     "detections.pose.pose.pose.position"},
    {"ar_track_alvar_msgs/AlvarMarkers", "markers", "markers.id", "markers.pose.pose.position"},
    {"aruco_msgs/MarkerArray", "markers", "markers.id", "markers.pose.pose.position"},
    {"fiducial_msgs/FiducialTransformArray", "transforms", "transforms.fiducial_id",
     "transforms.transform.translation"},
    {"vision_msgs/Detection3DArray", "detections", "detections.id", "detections.bbox.center.position"},
};

class MarkerReader : public TopicReader {
 public:
  MarkerReader(const std::string& type, std::vector<Sighting>* rows)
      : type_(*std::ranges::find(kMarkerTypes, std::string_view(type), &MarkerType::type)), rows_(*rows) {}
  std::vector<std::string> paths() const override {
    const std::string position(type_.position);
    return {std::string(type_.each), std::string(type_.id), position + ".x", position + ".y", position + ".z",
            "header.stamp", "header.frame_id", std::string(type_.each) + ".header.frame_id",
            // ar_track_alvar leaves the array's own header empty.
            std::string(type_.each) + ".header.stamp"};
  }
  std::size_t needed() const override { return 6; }
  void Take(const std::vector<Found>& found, const Message& message, TopicClock* clock) override {
    const auto count = static_cast<std::size_t>(OneOf(found[0]));
    if (count == 0) return;
    const Found& id = found[1];
    if (id.numbers.size() + id.texts.size() != count)
      throw LineError{"markers of other than one number", "bundles of tags are not landmarks"};
    std::vector<double> stamp = found[5].numbers;
    if (OneOf(found[5]) == 0 && !found[8].numbers.empty()) stamp = {found[8].numbers.front()};
    const auto time_s = clock->At(stamp, message.receive_ns);
    if (!time_s) return;
    for (std::size_t i = 0; i < count; ++i) {
      Sighting seen{*time_s, message.number, {}, {At(found[2], i), At(found[3], i), At(found[4], i)}, {}};
      seen.name = id.texts.empty() ? NumberName(id.numbers[i]) : Printable(std::string(id.texts[i]), 100);
      seen.frame = FrameName(TextIn(found[6]));
      if (seen.frame.empty() && i < found[7].texts.size()) seen.frame = FrameName(found[7].texts[i]);
      if (!(std::hypot(seen.point.x, seen.point.y, seen.point.z) < 1e4))
        throw LineError{"no place of a marker", "marker " + seen.name};
      rows_.push_back(std::move(seen));
    }
  }

 private:
  static std::string NumberName(double id) {
    if (!(std::abs(id) < 1e15)) throw LineError{"no number of a marker", std::to_string(id)};
    return std::to_string(static_cast<std::int64_t>(id));
  }
  static double At(const Found& found, std::size_t i) {
    if (i >= found.numbers.size()) throw LineError{"markers without a place each", ""};
    return found.numbers[i];
  }
  const MarkerType& type_;
  std::vector<Sighting>& rows_;
};

}  // namespace

std::optional<double> TopicClock::At(const std::vector<double>& header, std::int64_t receive_ns) {
  const double received_s = SecondsOf(receive_ns);
  const bool has_header = !header.empty();
  if (has_header && header.front() > 0) {
    const double delay_s = received_s - header.front();
    least_delay_s_ = std::min(delay_s, least_delay_s_.value_or(delay_s));
  }
  if (has_header && !options_.by_receipt && header.front() <= 0)
    throw LineError{"no time in its header",
                    "0: recorded with /use_sim_time and no clock? --by-receipt takes the recorder's times"};
  const double time_s = has_header && !options_.by_receipt ? header.front() : received_s;
  constexpr double kMostLate_s = 1;
  if (time_s < latest_s_ - kMostLate_s)
    throw LineError{"time runs backwards", std::to_string(time_s) + " after " + std::to_string(latest_s_)};
  latest_s_ = std::max(latest_s_, time_s);
  return WithinPath(time_s);
}

std::optional<double> TopicClock::WithinPath(double time_s) const {
  if (time_s < options_.from_s || time_s > options_.until_s) return std::nullopt;
  return time_s;
}

double TopicClock::TransformTime(double header_s, std::int64_t receive_ns) const {
  return options_.by_receipt ? SecondsOf(receive_ns) : header_s;
}

std::unique_ptr<TopicReader> ReadOdometry(OdometryRows* rows) {
  return std::make_unique<OdometryReader>(rows);
}
std::unique_ptr<TopicReader> ReadVelocity(const std::string& type, OdometryRows* rows) {
  return std::make_unique<VelocityReader>(type, rows);
}
std::unique_ptr<TopicReader> ReadTransforms(FrameTree* frames) {
  return std::make_unique<TransformReader>(frames);
}
std::unique_ptr<TopicReader> ReadScans(const std::string& type, ScanTopic* topic) {
  if (type == "sensor_msgs/Range") return std::make_unique<ConeReader>(topic);
  return std::make_unique<ScanReader>(type == "sensor_msgs/MultiEchoLaserScan", topic);
}
std::unique_ptr<TopicReader> ReadPoses(const std::string& type, std::vector<PoseRow>* rows) {
  return std::make_unique<PoseReader>(type, rows);
}
std::unique_ptr<TopicReader> ReadLandmarks(const std::string& type, std::vector<Sighting>* rows) {
  return std::make_unique<MarkerReader>(type, rows);
}

}  // namespace cairn::datasets::bag
