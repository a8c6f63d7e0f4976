// Logs of a robot with sonars and infra-red on a turret that drives through an office: the problem of
// [DM98].
#pragma once

#include <cstdint>

#include "schema/blob.h"

namespace cairn::datasets {

struct SimulateOfficeOptions {
  double minutes = 10;  // of driving, from 1 to 120
  bool moved = false;   // furniture moves once half of the time is over; some minutes are too few
  bool turned = false;  // one more room, whose walls are turned by 30 degrees
  bool hints = false;   // somebody marks the doorways
  bool persons = true;
  std::uint64_t seed = 1;
};

// A `log` with its truth (schema/FORMAT.md): five scans a second, odometry with the figures of
// SimulateLoop's `base` and nothing that mends it. Office and drive do not depend on `persons`, `hints`.
// Throws InputError for what is out of range.
Blob SimulateOffice(const SimulateOfficeOptions& options);

}  // namespace cairn::datasets
