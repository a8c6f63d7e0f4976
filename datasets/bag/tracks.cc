#include "datasets/bag/tracks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "schema/error.h"
#include "schema/text.h"

namespace cairn::datasets::bag {
namespace {

// Poses in the order of time, and what lies between two of them that are at most a second apart.
class TrackInTime {
 public:
  explicit TrackInTime(SpooledRows<TimedPose> poses) : poses_(std::move(poses)) {
    poses_.EraseIf([](const TimedPose& pose) { return pose.time_s <= 0; });
    SortRows(&poses_, [](const TimedPose& pose) { return pose.time_s; });
  }
  const SpooledRows<TimedPose>& poses() const { return poses_; }
  // At times that rise.
  std::optional<Pose> At(double time_s) {
    constexpr double kMostGap_s = 1;
    while (next_ < poses_.size() && poses_[next_].time_s < time_s) ++next_;
    if (next_ == poses_.size()) return std::nullopt;
    const TimedPose& next = poses_[next_];
    if (next.time_s == time_s) return next.pose;
    if (next_ == 0 || next.time_s - poses_[next_ - 1].time_s > kMostGap_s) return std::nullopt;
    const TimedPose& before = poses_[next_ - 1];
    return Interpolate(before.pose, next.pose, (time_s - before.time_s) / (next.time_s - before.time_s));
  }

 private:
  SpooledRows<TimedPose> poses_;
  std::size_t next_ = 0;
};

SpooledRows<TimedPose> TimedPosesOf(const SpooledRows<PoseRow>& rows) {
  SpooledRows<TimedPose> poses(rows.folder());
  for (const PoseRow& row : rows) poses.push_back({row.time_s, row.pose});
  return poses;
}

// What two tracks say of the time that both cover, second by second.
struct Course {
  double way_m = 0, turn_rad = 0, turns_rad = 0;  // left less right; left and right together
  void Add(const Pose& from, const Pose& to) {
    way_m += DistanceM({from.x_m, from.y_m}, {to.x_m, to.y_m});
    turn_rad += WrapAngle(to.heading_rad - from.heading_rad);
  }
};

}  // namespace

SpooledRows<PoseRow> PosesOnMap(const FrameTree& frames, const std::string& robot, const std::string& base,
                                const std::string& whose, ImportReport* report) {
  const FrameTree::Links on_map = frames.MovingOn("map", robot), on_odom = frames.MovingOn("odom", robot);
  if (on_map.empty()) throw InputError(whose + ": there is no frame in tf that lies on one called 'map'");
  // What carries odometry, else the robot itself: markers lie on the map, too.
  const auto carries = [&](const auto& one) {
    return std::ranges::find(on_odom, one.second, &FrameTree::Links::value_type::first) != on_odom.end();
  };
  auto chosen = std::ranges::find_if(on_map, carries);
  if (chosen == on_map.end()) chosen = std::ranges::find(on_map, base, &FrameTree::Links::value_type::second);
  if (chosen == on_map.end()) chosen = on_map.begin();
  const std::string& odom = chosen->second;
  const auto link = std::ranges::find(on_odom, odom, &FrameTree::Links::value_type::first);
  // Without odometry in between the frame on the map is the robot's, or carries it.
  const std::string& moving = link == on_odom.end() ? odom : link->second;
  Pose mount;
  if (const auto found = frames.Find(moving, base)) mount = found->transform.Planar();
  TrackInTime map(frames.TrackOf(odom));
  const TrackInTime path(link == on_odom.end() ? SpooledRows<TimedPose>() : frames.TrackOf(moving));
  SpooledRows<PoseRow> poses(map.poses().folder());
  std::int64_t without = 0;
  for (const TimedPose& pose : link == on_odom.end() ? map.poses() : path.poses()) {
    const auto on = link == on_odom.end() ? std::optional<Pose>(pose.pose) : map.At(pose.time_s);
    if (!on) {
      ++without;
      continue;
    }
    Pose at = link == on_odom.end() ? Compose(*on, mount) : Compose(Compose(*on, pose.pose), mount);
    at.heading_rad = WrapAngle(at.heading_rad);
    poses.push_back({pose.time_s, poses.size() + 1, at});
  }
  const std::string chain = chosen->first + " > " + odom + (link == on_odom.end() ? "" : " > " + moving);
  if (poses.empty())
    throw InputError(whose + ": the transforms of '" + Printable(chain, 200) + "' have no time in common");
  report->read["poses of " + chain + " in tf"] = static_cast<std::int64_t>(poses.size());
  if (without > 0)
    report->dropped["transforms of " + moving + " at a time at which tf has no map"] += without;
  return poses;
}

void CompareOdometries(const std::string& one, const SpooledRows<PoseRow>& ones, const std::string& other,
                       const SpooledRows<PoseRow>& others, ImportReport* report) {
  // By less than kTurning_rad in a step a heading may change that stands.
  constexpr double kStep_s = 1, kShare = 0.1, kLeast_m = 0.5, kLeast_rad = 0.2, kTurning_rad = 0.05;
  if (ones.empty() || others.empty()) return;
  const TrackInTime a(TimedPosesOf(ones));
  TrackInTime b(TimedPosesOf(others));
  if (a.poses().empty() || b.poses().empty()) return;
  Course of_a, of_b;
  double last_s = -1, covered_s = 0, turned_rad = 0;
  std::optional<Pose> last_a, last_b;
  for (const TimedPose& pose : a.poses()) {
    const double step_s = pose.time_s - last_s;
    if (step_s < kStep_s) continue;
    const auto now_b = b.At(pose.time_s);
    if (step_s < 2 * kStep_s && now_b && last_b) {
      covered_s += step_s;
      const double turn_a = std::abs(WrapAngle(pose.pose.heading_rad - last_a->heading_rad)),
                   turn_b = std::abs(WrapAngle(now_b->heading_rad - last_b->heading_rad));
      turned_rad += turn_a;
      if (std::max(turn_a, turn_b) >= kTurning_rad) {
        of_a.turns_rad += turn_a;
        of_b.turns_rad += turn_b;
      }
      of_a.Add(*last_a, pose.pose);
      of_b.Add(*last_b, *now_b);
    }
    last_s = pose.time_s;
    last_a = pose.pose;
    last_b = now_b;
  }
  const double apart_m = std::abs(of_a.way_m - of_b.way_m),
               apart_rad = std::abs(of_a.turn_rad - of_b.turn_rad);
  const bool same_turn = apart_rad <= kLeast_rad + kShare * turned_rad;
  const bool same_turns = std::abs(of_a.turns_rad - of_b.turns_rad) <=
                          kLeast_rad + kShare * std::max(of_a.turns_rad, of_b.turns_rad);
  if (apart_m <= kLeast_m + kShare * std::max(of_a.way_m, of_b.way_m) && same_turn && same_turns) return;
  const bool by_turns = same_turn && !same_turns;
  report->warnings.push_back(
      fmt::format("{} and {} contradict each other: in the {:.0f} s that both cover the one goes {:.1f} m "
                  "and turns by {:.2f} "
                  "rad{}, the other {:.1f} m and {:.2f} rad; the log has the first",
                  one, other, covered_s, of_a.way_m, by_turns ? of_a.turns_rad : of_a.turn_rad,
                  by_turns ? " to the left and the right together" : "", of_b.way_m,
                  by_turns ? of_b.turns_rad : of_b.turn_rad));
}

}  // namespace cairn::datasets::bag
