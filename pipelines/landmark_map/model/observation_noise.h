// How exact one observation is.
#pragma once

namespace cairn::landmark_map {

// Standard deviations of where an observed landmark stands relative to the robot: along the ray to it, and
// across.
struct ObservationWidths {
  double along_m, across_m;
};

// A range-bearing observation errs in its range and in its bearing: the farther it is, the wider it lies
// across its ray.
struct ObservationNoise {
  double contact_m = 0.3;  // of a landmark at the robot itself, along either axis
  double range_m = 0.3;
  double bearing_rad = 0.02;

  // Of a landmark seen at (x_m, y_m) from the robot; (0, 0): a contact detection.
  ObservationWidths At(double x_m, double y_m) const;
};

}  // namespace cairn::landmark_map
