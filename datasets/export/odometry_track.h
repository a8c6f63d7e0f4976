// What a log's odometry says of a robot's motion between two times, and how far off that may be.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "datasets/common/control.h"
#include "schema/geometry.h"
#include "schema/kinds/log.h"

namespace cairn::datasets {

// What a robot's odometry errs by all along, which is taken off, and standard deviations of what it errs by
// anew: of its heading's random walk, of turns, of ways. As landmark_map's refinement has them.
struct OdometryErrors {
  double drift_rad_per_m = 0, distance_scale = 1, turn_scale = 1;
  double walk_rad_per_sqrt_m = 0, turn_rad_per_sqrt_rad = 0, way_m_per_sqrt_m = 0;
};

// From the frame of the first pose to the second one; the heading is not wrapped.
struct OdometryMotion {
  Pose pose;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // of x, y [m], heading [rad]
};

class OdometryTrack {
 public:
  OdometryTrack(const kinds::Log::Odometry& odometry, const OdometryErrors& errors);

  // Of a control that is under way at either end that part which lies between: its turn comes first.
  OdometryMotion Between(double from_s, double to_s) const;
  // Where the robot was at `at_s`, as its pose at `from_s` saw it, if it came to `end` at `to_s`: by
  // odometry, bent so that it ends there.
  Pose BentTo(const Pose& end, double from_s, double at_s, double to_s) const;
  // By what the odometry's distances are to be multiplied to be those of a path, on average: by least squares
  // over its motions from pose to pose. 1 where it does not move.
  double ScaleOf(const std::vector<double>& time_s, const std::vector<Pose>& poses) const;

 private:
  std::vector<Control> ControlsBetween(double from_s, double to_s) const;
  OdometryMotion Integral(const std::vector<Control>& controls) const;

  std::vector<double> time_s_;  // [controls + 1], the first where the first control begins
  std::vector<Control> controls_;
  OdometryErrors errors_;
};

}  // namespace cairn::datasets
