// What a log's observations are like, all together.
#pragma once

#include <cstdint>

#include "schema/kinds/log.h"

namespace cairn::landmark_map {

struct Sensing {
  std::int64_t observations = 0, ranged = 0, identified = 0;
  double mean_range_m = 0.0, max_range_m = 0.0;
  double between_m = 0.0;  // distance from one observation to the next, the median
};

Sensing LookAt(const kinds::Log& log);

// From one of a robot's observations to the next; 0 where there are no two.
double MedianDistanceBetween(const kinds::Log::Robot& robot);

}  // namespace cairn::landmark_map
