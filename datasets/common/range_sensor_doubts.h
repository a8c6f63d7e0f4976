// All that is said of a log's range sensors, where a log is imported, looked at or mapped: readings that mean
// nothing, beams that are stuck, rings that are turned.
#pragma once

#include <string>
#include <vector>

#include "schema/blob.h"

namespace cairn::datasets {

// Forgives what is missing.
std::vector<std::string> RangeSensorDoubtsOf(const Blob& log);

}  // namespace cairn::datasets
