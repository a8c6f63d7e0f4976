// Controls in the plane.
#pragma once

#include "schema/geometry.h"

namespace cairn::datasets {

// First the turn, then the way forward.
struct Control {
  double turn_rad = 0;
  double forward_m = 0;
};

Pose Apply(const Pose& pose, const Control& control);

}  // namespace cairn::datasets
