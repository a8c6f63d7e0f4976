#include "datasets/common/control.h"

#include <cmath>

namespace cairn::datasets {

Pose Apply(const Pose& pose, const Control& control) {
  const double heading = WrapAngle(pose.heading_rad + control.turn_rad);
  return {pose.x_m + control.forward_m * std::cos(heading), pose.y_m + control.forward_m * std::sin(heading),
          heading};
}

}  // namespace cairn::datasets
