#include "pipelines/landmark_map/model/observation_noise.h"

#include <algorithm>
#include <cmath>

namespace cairn::landmark_map {

ObservationWidths ObservationNoise::At(double x_m, double y_m) const {
  constexpr double kLeast_m = 1e-3;  // nothing is more exact, not even what is seen at arm's length
  const double distance_m = std::hypot(x_m, y_m);
  if (distance_m == 0.0) return {std::max(kLeast_m, contact_m), std::max(kLeast_m, contact_m)};
  return {std::max(kLeast_m, range_m), std::max(kLeast_m, bearing_rad * distance_m)};
}

}  // namespace cairn::landmark_map
