// Points, poses and controls in the plane.
#pragma once

namespace cairn::datasets {

struct PointM {
  double x_m = 0;
  double y_m = 0;
};

struct PoseM {
  double x_m = 0;
  double y_m = 0;
  double heading_rad = 0;  // counter-clockwise from x
};

// First the turn, then the way forward.
struct Control {
  double turn_rad = 0;
  double forward_m = 0;
};

double DistanceM(PointM a, PointM b);
double WrapAngle(double angle_rad);  // to (-pi, pi]
PoseM Apply(const PoseM& pose, const Control& control);

}  // namespace cairn::datasets
