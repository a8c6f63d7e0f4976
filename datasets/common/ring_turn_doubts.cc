#include "datasets/common/ring_turn_doubts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "datasets/common/reckoning.h"

namespace cairn::datasets {
namespace {

constexpr double kRingDegree = std::numbers::pi / 180;
constexpr double kLeastStep_m = 0.15, kLongestVoteWay_m = 0.45, kStraightStep_rad = 4 * kRingDegree,
                 kLongestStep_s = 10;
constexpr double kLikeWay = 0.2;  // a range changes by the way, to that share of it
constexpr std::size_t kLeastSteps = 30, kLeastVotes = 150;
constexpr double kAgree = 0.5, kFar_rad = 40 * kRingDegree;

// A robot's poses at the times of a sensor's scans, up to the last of its path.
std::vector<Pose> PosesAt(const kinds::Log::Robot& robot, const Walked<double>& time_s) {
  std::vector<Pose> poses;
  if (robot.HasControls()) {
    const Reckoning reckoning(robot.odometry);
    for (const double time : time_s) poses.push_back(reckoning.At(time));
    return poses;
  }
  if (!robot.poses.time_s || robot.poses.time_s.empty()) return {};
  const Walked<double> at_s = robot.poses.time_s.array();
  const std::vector<Pose> of_table = robot.poses.poses();
  std::size_t next = 0;
  for (const double time : time_s) {
    while (next + 1 < at_s.size() && std::abs(at_s[next + 1] - time) <= std::abs(at_s[next] - time)) ++next;
    poses.push_back(of_table[next]);
  }
  return poses;
}

// Beams whose readings change as the way between two scans tells of what lies ahead, and behind.
class Votes {
 public:
  explicit Votes(const kinds::Log::RangeSensor& sensor) : sensor_(sensor), range_m_(sensor.range_m.array()) {}

  void Add(std::size_t from, std::size_t to, const Pose& moved) {
    const double way_m = std::hypot(moved.x_m, moved.y_m), towards_rad = std::atan2(moved.y_m, moved.x_m);
    const std::size_t beams = sensor_.beam_heading_rad.size(), before = readings_;
    for (std::size_t b = 0; b < beams; ++b) {
      const double grows_m = range_m_[to * beams + b] - range_m_[from * beams + b];
      const double vote = std::abs(grows_m + way_m) < kLikeWay * way_m   ? 1
                          : std::abs(grows_m - way_m) < kLikeWay * way_m ? -1
                                                                         : 0;
      if (vote == 0) continue;
      ++readings_;
      const double off_rad = sensor_.beam_heading_rad[b] - towards_rad;
      ahead_ += vote * std::cos(off_rad);
      aside_ += vote * std::sin(off_rad);
    }
    steps_ += readings_ > before ? 1 : 0;
  }

  std::optional<double> TurnRad() const {
    if (steps_ < kLeastSteps || readings_ < kLeastVotes) return std::nullopt;
    if (std::hypot(ahead_, aside_) < kAgree * static_cast<double>(readings_)) return std::nullopt;
    return -std::atan2(aside_, ahead_);
  }

 private:
  const kinds::Log::RangeSensor& sensor_;
  Walked<double> range_m_;
  std::size_t steps_ = 0, readings_ = 0;
  double ahead_ = 0, aside_ = 0;
};

bool IsWholeRing(const kinds::Log::RangeSensor& sensor) {
  const std::size_t beams = sensor.beam_heading_rad.OrNone().size();
  return beams > 1 && !sensor.turret_rad && sensor.time_s && sensor.range_m &&
         sensor.range_m.size() == beams * sensor.time_s.size();
}

}  // namespace

std::optional<double> RingTurnRad(const kinds::Log::Robot& robot, const kinds::Log::RangeSensor& sensor) {
  if (!IsWholeRing(sensor)) return std::nullopt;
  const Walked<double> time_s = sensor.time_s.array();
  const std::vector<Pose> poses = PosesAt(robot, time_s);
  Votes votes(sensor);
  std::size_t from = 0;
  for (std::size_t to = 1; to < poses.size(); ++to) {
    const Pose moved = Between(poses[from], poses[to]);
    const double way_m = std::hypot(moved.x_m, moved.y_m);
    const bool is_straight = std::abs(WrapAngle(moved.heading_rad)) <= kStraightStep_rad &&
                             time_s[to] - time_s[from] <= kLongestStep_s;
    if (is_straight && way_m < kLeastStep_m) continue;
    if (is_straight && way_m < kLongestVoteWay_m) votes.Add(from, to, moved);
    from = to;
  }
  return votes.TurnRad();
}

std::vector<std::string> RingTurnDoubtsOf(const Blob& log) {
  const auto parts = Read<kinds::Log>(log);
  const std::vector<std::string>& robots = parts.robots.OrNone();
  std::vector<std::string> texts;
  for (std::size_t n = 0; n < std::min(robots.size(), parts.robot.size()); ++n) {
    for (const kinds::Log::RangeSensor& sensor : parts.robot[n].sensors) {
      const auto turn_rad = RingTurnRad(parts.robot[n], sensor);
      if (!turn_rad || std::abs(*turn_rad) < kFar_rad) continue;
      texts.push_back(fmt::format(
          "robot '{}', its {}: where the robot drives, what beams see that point {:.0f} degrees "
          "from ahead comes "
          "nearer as what lies ahead should: is the sensor turned by about {:.0f} degrees from "
          "how the log has "
          "it (robot/{}/{}/beam_heading_rad)? A grid map would show walls where none are",
          robots[n], sensor.sensor, -*turn_rad / kRingDegree, *turn_rad / kRingDegree, n, sensor.sensor));
    }
  }
  return texts;
}

}  // namespace cairn::datasets
