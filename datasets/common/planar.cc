#include "datasets/common/planar.h"

#include <cmath>
#include <numbers>

namespace cairn::datasets {

double DistanceM(PointM a, PointM b) { return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m); }

double WrapAngle(double angle_rad) {
  const double wrapped = std::remainder(angle_rad, 2 * std::numbers::pi);
  return wrapped <= -std::numbers::pi ? std::numbers::pi : wrapped;
}

PoseM Apply(const PoseM& pose, const Control& control) {
  const double heading = WrapAngle(pose.heading_rad + control.turn_rad);
  return {pose.x_m + control.forward_m * std::cos(heading), pose.y_m + control.forward_m * std::sin(heading),
          heading};
}

}  // namespace cairn::datasets
