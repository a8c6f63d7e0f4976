#include "pipelines/common/pose_track.h"

#include <algorithm>
#include <cmath>

#include "pipelines/common/handed_over.h"
#include "schema/error.h"
#include "schema/kinds/kind.h"
#include "schema/text.h"

namespace cairn {
namespace {

std::string Prefix(std::size_t robot) { return "robot/" + std::to_string(robot) + "/"; }

std::size_t IndexOf(const std::vector<std::string>& robots, const std::string& name) {
  const auto found = std::ranges::find(robots, name);
  if (found == robots.end()) {
    throw InputError("there are no poses of robot '" + name + "'; the table has poses of " +
                     NameList(robots) +
                     ". Robots have one name in both (`cairn import tum --robot NAME` gives it)");
  }
  return static_cast<std::size_t>(found - robots.begin());
}

Pose Part(const Pose& from, double part, const Pose& by) {
  return {from.x_m + part * by.x_m, from.y_m + part * by.y_m, from.heading_rad + part * by.heading_rad};
}

}  // namespace

PoseTrack PoseTrack::Of(const Blob& log, const Blob* poses, std::size_t index, double gap_s) {
  const std::string name = log.Texts("robots").at(index);
  const auto robot = FieldsIn<kinds::Log::Robot>(Prefix(index), log);
  PoseTrack track;
  track.gap_s_ = gap_s;
  if (robot.HasControls()) track.odometry_ = Integrate(robot.odometry, name);
  if (poses != nullptr) {
    const std::string prefix = Prefix(IndexOf(poses->Texts("robots"), name));
    track.Set(FieldsIn<kinds::PoseTable>(prefix + "poses/", *poses), name);
    track.has_own_frame_ = KindOf(*poses) == "local_map";
  } else if (robot.poses.time_s) {
    track.Set(robot.poses, name);
  } else if (!track.odometry_) {
    throw InputError("robot '" + name + "' has neither poses nor odometry: where it was is not known");
  } else {
    track.has_own_frame_ = true;
  }
  return track;
}

void PoseTrack::Set(const kinds::PoseTable& poses, const std::string& robot) {
  if (poses.time_s.empty()) throw InputError("robot '" + robot + "': '" + poses.time_s.name() + "' is empty");
  for (const auto* column : {&poses.x_m, &poses.y_m, &poses.heading_rad})
    RequireSize(column->name(), column->size(), poses.time_s.size());
  time_s_ = poses.time_s.vector();
  pose_ = poses.poses();
}

std::optional<Pose> PoseTrack::Odometric(double time_s) const {
  if (!odometry_) return std::nullopt;
  const OdometricPose pose = PoseAt(*odometry_, time_s);
  return Pose{pose.x_m, pose.y_m, pose.heading_rad};
}

std::optional<Pose> PoseTrack::At(double time_s) const {
  if (time_s_.empty()) return Odometric(time_s);
  const auto next = static_cast<std::size_t>(std::ranges::lower_bound(time_s_, time_s) - time_s_.begin());
  if (next < time_s_.size() && time_s_[next] == time_s) return pose_[next];
  if (next == 0 || next == time_s_.size()) return std::nullopt;
  const double interval_s = time_s_[next] - time_s_[next - 1];
  if (gap_s_ > 0 && interval_s > gap_s_) return std::nullopt;
  const double part = (time_s - time_s_[next - 1]) / interval_s;
  const Pose &before = pose_[next - 1], &after = pose_[next];
  Pose moved = before, arrived = before;
  if (odometry_) {
    const Pose start = *Odometric(time_s_[next - 1]);
    moved = Compose(before, Between(start, *Odometric(time_s)));
    arrived = Compose(before, Between(start, *Odometric(time_s_[next])));
  }
  return Part(
      moved, part,
      {after.x_m - arrived.x_m, after.y_m - arrived.y_m, WrapAngle(after.heading_rad - arrived.heading_rad)});
}

}  // namespace cairn
