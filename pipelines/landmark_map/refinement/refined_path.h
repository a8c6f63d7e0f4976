// A robot's nodes in time, and its path from one to the next: odometry, bent so that it ends where the next
// one is.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "pipelines/common/odometry.h"
#include "pipelines/landmark_map/refinement/least_squares.h"

namespace cairn::landmark_map {

// The controls from one time to a later one, of that under way at either end the part that lies between: its
// turn comes first (PoseAt, common/odometry.h). None that moves nothing.
std::vector<Control> ControlsBetween(const Odometry& odometry, double from_s, double to_s);

// Nodes at both ends of the odometry and at the times (which increase), but none where the robot has not
// moved since the node before. `node_of`: of each time.
NodeTrack TrackThrough(const Odometry& odometry, std::span<const double> times_s, std::vector<int>* node_of);

class RefinedPath {
 public:
  struct Pose {
    double x_m, y_m, heading_rad;
    Eigen::Matrix3d covariance;
  };

  RefinedPath(Odometry odometry, NodeTrack track, std::vector<Eigen::Vector3d> nodes,
              std::vector<Eigen::Matrix3d> covariances, SystematicErrors errors, EdgeWidths widths);

  // Between two nodes the error is that of a bridge: it grows with the way from either.
  Pose At(double time_s) const;
  const SystematicErrors& errors() const { return errors_; }
  const EdgeWidths& widths() const { return widths_; }

 private:
  Odometry odometry_;
  NodeTrack track_;
  std::vector<Eigen::Vector3d> nodes_;
  std::vector<Eigen::Matrix3d> covariances_;
  SystematicErrors errors_;
  EdgeWidths widths_;
};

}  // namespace cairn::landmark_map
