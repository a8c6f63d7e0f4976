// Where odometry is missing in the midst of a log: between two rows much farther apart than usual the robot
// moved, and observed; or neither odometry nor observations were recorded while it went on. A robot that
// stands still may say nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "schema/blob.h"

namespace cairn {

struct OdometryHole {
  std::int32_t robot = 0;
  double begin_s = 0, length_s = 0;
  double usual_s = 0;               // between two rows
  double missing_m = 0;             // of what it travelled, by its speed before and after; 0: a row tells
  std::ptrdiff_t observations = 0;  // meanwhile
};

// By robot and time. None of columns that are missing or of another type.
std::vector<OdometryHole> FindOdometryHoles(const Blob& log);

// A sentence for people for each robot of the log that has such holes: when and how long the longest is, and
// whether the row after it says how far it went. Of columns that are missing or of another type it says
// nothing.
std::vector<std::string> OdometryHolesOf(const Blob& log);

}  // namespace cairn
