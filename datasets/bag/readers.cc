#include "datasets/bag/readers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "schema/text.h"

namespace cairn::datasets::bag {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

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
  OdometryReader(OdometryRows* rows, bool is_aside) : rows_(*rows), is_aside_(is_aside) {}
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
      rows_.frame = FrameName(FirstText(found[kPosePaths + 1]));
      rows_.base = FrameName(FirstText(found[kPosePaths + 2]));
      rows_.first_variance = variance;
      rows_.has_covariances = covariance.size() == kVariances;
    }
    rows_.last_variance = variance;
    rows_.poses.push_back({*time_s, message.number, pose.Planar()});
  }
  bool is_aside() const override { return is_aside_; }

 private:
  OdometryRows& rows_;
  bool is_aside_;
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
    const double ahead = FirstNumber(found[0]), aside = FirstNumber(found[1]), turn = FirstNumber(found[2]);
    if (!(std::abs(ahead) < kMost && std::abs(aside) < kMost && std::abs(turn) < kMost))
      throw LineError{"no velocity", std::to_string(ahead) + " " + std::to_string(aside) + " m/s, " +
                                         std::to_string(turn) + " rad/s"};
    const auto time_s = clock->At(found[3].numbers, message.receive_ns);
    if (!time_s || (!rows_.poses.empty() && *time_s < rows_.poses.back().time_s)) return;
    Pose pose;
    if (!rows_.poses.empty()) {
      const double seconds = *time_s - rows_.poses.back().time_s;
      pose = Moved(rows_.poses.back().pose, ahead_ * seconds, aside_ * seconds, turn_ * seconds);
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
  TransformReader(bool are_static, std::vector<TransformsOf> robots)
      : are_static_(are_static), robots_(std::move(robots)) {}
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
      const std::string child = FrameName(children[i]), parent = FrameName(parents[i]);
      const auto time_s = are_static_ ? std::nullopt : clock->WithinPath(stamp_s);
      for (const TransformsOf& robot : robots_) {
        if (time_s)
          Follow(
              {stamps[i], {*time_s, message.number, child, {transform.x, transform.y, transform.z}, parent}},
              robot.followed);
        robot.frames->Add(parent, child, stamp_s, transform);
      }
    }
  }

 private:
  static void Follow(const FrameSighting& one, FollowedFrames* followed) {
    const std::string& frame = one.seen.name;
    if (followed->with_tags && IsTag(frame)) followed->tags.push_back(one);
    if (std::ranges::any_of(followed->beginnings, [&](const auto& b) { return frame.starts_with(b); }))
      followed->seen.push_back(one);
  }
  // "tag36h11:7".
  static bool IsTag(std::string_view frame) {
    const std::size_t colon = frame.find(':');
    return colon != std::string_view::npos && colon + 1 < frame.size() &&
           frame.find_first_not_of("0123456789", colon + 1) == std::string_view::npos;
  }

  bool are_static_;
  std::vector<TransformsOf> robots_;
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
            "ranges",
            has_echoes_ ? "intensities.echoes" : "intensities"};
  }
  std::size_t needed() const override { return 5; }
  void Take(const std::vector<Found>& found, const Message& message, TopicClock* clock) override {
    const std::vector<double>& ranges = found[0].numbers;
    const double first = FirstNumber(found[1]), step = FirstNumber(found[2]), reach = FirstNumber(found[3]);
    const auto time_s = clock->At(found[4].numbers, message.receive_ns);
    if (!time_s) return;
    if (has_echoes_ && FirstNumber(found[7]) != static_cast<double>(ranges.size()))
      throw LineError{"beams of other than one echo", "take the topic of first echoes as LaserScan"};
    if (topic_.times.empty() && topic_.beams == 0) Begin(first, step, reach, ranges.size(), found[6]);
    if (ranges.size() != topic_.beams)
      throw LineError{"other beams than the topic's first scan",
                      std::to_string(ranges.size()) + " instead of " + std::to_string(topic_.beams)};
    constexpr double kSame = 1e-4;
    if (!(std::abs(first - topic_.first_rad) < kSame && std::abs(step - topic_.step_rad) < kSame))
      throw LineError{"other geometry than the topic's first scan", "its start angle or increment changed"};
    topic_.times.push_back({*time_s, message.number});
    // REP 117: nearer than the least range is no reading, NaN none, infinity nothing within reach.
    intensity_.clear();
    if (found[8].numbers.size() == ranges.size())
      intensity_.assign(found[8].numbers.begin(), found[8].numbers.end());
    topic_.scans.Add(ranges, FirstNumber(found[5]), intensity_);
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
    topic_.frame = FrameName(FirstText(frame));
    topic_.first_rad = first;
    topic_.step_rad = step;
    topic_.max_range_m = reach;
    topic_.beams = beams;
    topic_.scans = ScanRows(topic_.folder, beams, reach);
  }

  bool has_echoes_;
  ScanTopic& topic_;
  std::vector<float> intensity_;
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
    const double reach = FirstNumber(found[1]), opening = FirstNumber(found[2]);
    const auto time_s = clock->At(found[4].numbers, message.receive_ns);
    if (!time_s) return;
    if (topic_.beams == 0) {
      if (!(reach > 0 && reach <= 1e4))
        throw LineError{"no reach", "max_range " + std::to_string(reach) + " m"};
      if (!(opening >= 0 && opening < 7))
        throw LineError{"no cone", "field_of_view " + std::to_string(opening) + " rad"};
      topic_.frame = FrameName(FirstText(found[6]));
      topic_.max_range_m = reach;
      topic_.opening_rad = opening;
      topic_.is_infrared = FirstNumber(found[3]) == 1;
      topic_.beams = 1;
    }
    const double range = FirstNumber(found[0]);
    topic_.cones.push_back({*time_s, message.number, range >= FirstNumber(found[5]) ? range : kNone});
  }

 private:
  ScanTopic& topic_;
};

class PoseReader : public TopicReader {
 public:
  PoseReader(const std::string& type, SpooledRows<PoseRow>* rows) : rows_(*rows) {
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
      if (i > 0 && !(stamps[i] >= stamps[i - 1])) throw LineError{kRunsBackwards, "within a path"};
      if (const auto time_s = clock->WithinPath(stamps[i]))
        rows.push_back({*time_s, message.number, pose.Planar()});
    }
    if (rows.size() >= rows_.size()) rows_ = rows;
  }

 private:
  SpooledRows<PoseRow>& rows_;
  std::string at_ = "pose.";
  bool is_path_ = false, is_transform_ = false;
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
    throw LineError{kRunsBackwards, std::to_string(time_s) + " after " + std::to_string(latest_s_)};
  if (Leaps(time_s, received_s))
    throw LineError{"time jumps ahead",
                    std::to_string(time_s) + " after " + std::to_string(latest_s_) +
                        ", while the recorder's clock went on by " +
                        std::to_string(received_s - latest_received_s_) +
                        " s: was a clock set anew? --by-receipt takes the recorder's times"};
  if (taken_++ == 0) {
    first_s_ = time_s;
    first_received_s_ = received_s;
  }
  latest_s_ = std::max(latest_s_, time_s);
  latest_received_s_ = received_s;
  return WithinPath(time_s);
}

bool TopicClock::Leaps(double time_s, double received_s) const {
  constexpr double kLeast_s = 60, kLeastCovered_s = 1, kSame = 0.5;
  constexpr std::int64_t kLeastTaken = 5;
  const double went_s = latest_s_ - first_s_, passed_s = latest_received_s_ - first_received_s_;
  const bool goes_along =
      taken_ >= kLeastTaken && passed_s >= kLeastCovered_s && std::abs(went_s - passed_s) <= kSame * passed_s;
  return goes_along && received_s >= latest_received_s_ &&
         (time_s - latest_s_) - (received_s - latest_received_s_) > kLeast_s;
}

std::optional<double> TopicClock::WithinPath(double time_s) const {
  if (time_s < options_.from_s || time_s > options_.until_s) return std::nullopt;
  return time_s;
}

double TopicClock::TransformTime(double header_s, std::int64_t receive_ns) const {
  return options_.by_receipt ? SecondsOf(receive_ns) : header_s;
}

std::unique_ptr<TopicReader> ReadOdometry(OdometryRows* rows, bool is_aside) {
  return std::make_unique<OdometryReader>(rows, is_aside);
}
std::unique_ptr<TopicReader> ReadVelocity(const std::string& type, OdometryRows* rows) {
  return std::make_unique<VelocityReader>(type, rows);
}
std::unique_ptr<TopicReader> ReadTransforms(bool are_static, std::vector<TransformsOf> robots) {
  return std::make_unique<TransformReader>(are_static, std::move(robots));
}
std::unique_ptr<TopicReader> ReadScans(const std::string& type, ScanTopic* topic) {
  if (type == "sensor_msgs/Range") return std::make_unique<ConeReader>(topic);
  return std::make_unique<ScanReader>(type == "sensor_msgs/MultiEchoLaserScan", topic);
}
std::unique_ptr<TopicReader> ReadPoses(const std::string& type, SpooledRows<PoseRow>* rows) {
  return std::make_unique<PoseReader>(type, rows);
}

}  // namespace cairn::datasets::bag
