// Where odometry is missing in the midst of a log: between two rows much farther apart than usual the robot
// moved, and observed. A robot that stands still may say nothing.
#pragma once

#include <string>
#include <vector>

#include "schema/blob.h"

namespace cairn {

// A sentence for people for each robot of the log that has such holes: when and how long the longest is, and
// whether the row after it says how far it went. Of columns that are missing or of another type it says
// nothing.
std::vector<std::string> OdometryHolesOf(const Blob& log);

}  // namespace cairn
