// What a log's observations are like, all together, and how exact one is.
#pragma once

#include <cstdint>

#include "schema/kinds/log.h"

namespace cairn::landmark_map {

struct Sensing {
  std::int64_t observations = 0, ranged = 0, identified = 0;
  double mean_range_m = 0.0, max_range_m = 0.0;
  double between_m = 0.0;  // distance from one observation to the next, the median
  // From a landmark to the nearest other one that its image, the observations at one time, shows with it, or
  // to the end of view where it shows no other: the shortest but for a twentieth, which may be false.
  double apart_m = 0.0;
};

Sensing LookAt(const kinds::Log& log);

// From one observation of a robot to the next: the median, and from the tenth part that is shortest to the
// longest tenth, over the median. Nothing of fewer than two observations.
struct DistancesBetween {
  double median_m = 0, spread = 0;
};
DistancesBetween MeasureDistancesBetween(const kinds::Log::Robot& robot);

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
