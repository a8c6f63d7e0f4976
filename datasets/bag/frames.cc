#include "datasets/bag/frames.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string_view>

#include "datasets/bag/bytes.h"

namespace cairn::datasets::bag {
namespace {

constexpr double kSamePlace_m = 0.01, kSameTurn_rad = std::numbers::pi / 180;
constexpr std::size_t kMostFrames = 10'000;

bool IsCalled(const std::string& frame, const std::string& name) {
  return frame == name || frame.ends_with("/" + name);
}

bool IsTracked(const std::string& parent) { return IsCalled(parent, "odom") || IsCalled(parent, "map"); }

// The angle between two rotations.
double TurnBetween(const Transform& a, const Transform& b) {
  const double dot = std::abs(a.qx * b.qx + a.qy * b.qy + a.qz * b.qz + a.qw * b.qw);
  return 2 * std::acos(std::min(1.0, dot));
}

}  // namespace

double Transform::Yaw() const { return std::atan2(2 * (qw * qz + qx * qy), 1 - 2 * (qy * qy + qz * qz)); }

Transform Compose(const Transform& a, const Transform& b) {
  const PointInSpace at = Apply(a, {b.x, b.y, b.z});
  return {at.x,
          at.y,
          at.z,
          a.qw * b.qx + a.qx * b.qw + a.qy * b.qz - a.qz * b.qy,
          a.qw * b.qy - a.qx * b.qz + a.qy * b.qw + a.qz * b.qx,
          a.qw * b.qz + a.qx * b.qy - a.qy * b.qx + a.qz * b.qw,
          a.qw * b.qw - a.qx * b.qx - a.qy * b.qy - a.qz * b.qz};
}

Transform Inverse(const Transform& t) {
  Transform inverse{0, 0, 0, -t.qx, -t.qy, -t.qz, t.qw};
  const PointInSpace at = Apply(inverse, {-t.x, -t.y, -t.z});
  inverse.x = at.x;
  inverse.y = at.y;
  inverse.z = at.z;
  return inverse;
}

std::optional<Transform> MakeTransform(double x, double y, double z, double qx, double qy, double qz,
                                       double qw) {
  constexpr double kMost_m = 1e7, kRounding = 0.01;
  const double length = std::hypot(std::hypot(qx, qy), std::hypot(qz, qw));
  const bool is_somewhere = std::abs(x) < kMost_m && std::abs(y) < kMost_m && std::abs(z) < kMost_m;
  if (!is_somewhere || !(std::abs(length - 1) < kRounding)) return std::nullopt;
  return Transform{x, y, z, qx, qy, qz, qw};
}

std::string FrameName(std::string_view name) {
  if (name.starts_with('/')) name.remove_prefix(1);
  return std::string(name);
}

void FrameTree::Add(const std::string& parent, const std::string& child, double time_s,
                    const Transform& transform) {
  const auto [found, is_new] = frames_.try_emplace(child);
  Frame& frame = found->second;
  if (is_new && frames_.size() > kMostFrames) throw Damage{"transforms of more than 10,000 frames"};
  if (is_new) {
    frame.parent = parent;
    frame.first = transform;
    frame.track = SpooledRows<TimedPose>(folder_);
  }
  if (frame.parent != parent) return;  // of two parents the first
  const Transform& first = frame.first;
  frame.moves =
      frame.moves ||
      std::hypot(transform.x - first.x, transform.y - first.y, transform.z - first.z) > kSamePlace_m ||
      TurnBetween(first, transform) > kSameTurn_rad;
  if (IsTracked(parent)) frame.track.push_back({time_s, transform.Planar()});
}

std::vector<std::string> FrameTree::ChainOf(const std::string& frame) const {
  std::vector<std::string> chain = {frame};
  std::set<std::string_view> seen = {frame};
  for (auto at = frames_.find(frame); at != frames_.end(); at = frames_.find(at->second.parent)) {
    if (!seen.insert(at->second.parent).second) break;  // a circle
    chain.push_back(at->second.parent);
  }
  return chain;
}

std::optional<FrameTree::Mount> FrameTree::Find(const std::string& base, const std::string& frame) const {
  const std::vector<std::string> from = ChainOf(base), to = ChainOf(frame);
  const std::set<std::string_view> of_frame(to.begin(), to.end());
  const auto meets = std::ranges::find_if(from, [&](const auto& name) { return of_frame.contains(name); });
  if (meets == from.end()) return std::nullopt;
  Mount mount;
  // Of a frame on the one where the two chains meet.
  const auto on_meeting = [&](const std::vector<std::string>& chain) {
    Transform all;
    for (const std::string& name : chain) {
      if (name == *meets) break;
      const Frame& link = frames_.at(name);
      all = Compose(link.first, all);
      if (link.moves) mount.moves.push_back(name);
    }
    return all;
  };
  const Transform base_at = on_meeting(from), frame_at = on_meeting(to);
  mount.transform = *meets == base ? frame_at : Compose(Inverse(base_at), frame_at);
  return mount;
}

bool FrameTree::Knows(const std::string& frame) const {
  if (frames_.contains(frame)) return true;
  return std::ranges::any_of(frames_, [&](const auto& one) { return one.second.parent == frame; });
}

FrameTree::Links FrameTree::MovingOn(const std::string& parent, const std::string& robot) const {
  Links moving;
  for (const auto& [name, frame] : frames_)
    if (IsCalled(frame.parent, parent) && frame.track.size() > 1) moving.emplace_back(frame.parent, name);
  const auto is_own = [&](const auto& link) { return link.second.starts_with(robot + "/"); };
  if (!robot.empty() && std::ranges::any_of(moving, is_own))
    std::erase_if(moving, [&](const auto& link) { return !is_own(link); });
  return moving;
}

const SpooledRows<TimedPose>& FrameTree::TrackOf(const std::string& child) const {
  return frames_.at(child).track;
}

void FrameTree::ForgetTracks() {
  for (auto& [name, frame] : frames_) frame.track.clear();
}

}  // namespace cairn::datasets::bag
