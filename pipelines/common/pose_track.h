// Where a robot was at any time: from a table of poses, or by dead reckoning.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "pipelines/common/odometry.h"
#include "schema/blob.h"
#include "schema/geometry.h"

namespace cairn {

class PoseTrack {
 public:
  // Of robot `index` of the log: from `poses` (may be null; kind `poses`, `landmark_map` or `local_map`,
  // whose robot of the same name it is), else from the log's robot/N/poses/, else from its odometry alone.
  // Poses that are more than `gap_s` apart (0: any) say nothing of the time between them. Both were checked
  // as their kinds. Throws InputError that names the robot where
  // - `poses` is there and has none of that name;
  // - there is nothing of the three, or the arrays are empty.
  static PoseTrack Of(const Blob& log, const Blob* poses, std::size_t index, double gap_s);

  // Whether its poses are in a frame of this robot alone, which nothing lays beside another's: dead reckoning
  // from where it started, and the poses of a local_map.
  bool has_own_frame() const { return has_own_frame_; }

  // Between two poses as odometry says, with what it is off by at the second spread evenly over the time;
  // where there is none, straight on. None before the first, after the last and in gaps.
  std::optional<Pose> At(double time_s) const;

 private:
  PoseTrack() = default;
  void Set(const kinds::PoseTable& poses, const std::string& robot);
  std::optional<Pose> Odometric(double time_s) const;

  double gap_s_ = 0;
  bool has_own_frame_ = false;
  std::vector<double> time_s_;
  std::vector<Pose> pose_;
  std::optional<Odometry> odometry_;
};

}  // namespace cairn
