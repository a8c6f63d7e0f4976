// Logs made of a log: some of its robots, its data in reverse order.
#pragma once

#include <cstddef>
#include <vector>

#include "schema/blob.h"

namespace cairn::datasets {

// The log of these robots alone, in this order, with their truth. Observations of other robots are left out.
// Throws InputError for a robot that the log does not have.
Blob RobotsOf(const Blob& log, const std::vector<std::size_t>& robots);

// Robot `robot` alone, driving its way backwards from where it ended: the n-th of its O observations is the
// (O - n)-th, counted from 0, and time runs anew from 0. Localization in reversed data is the computation of
// beta ([TBF98] section 6). With the robot's true poses and associations.
// Throws InputError for a robot that the log does not have, or columns of different length.
Blob Reversed(const Blob& log, std::size_t robot);

}  // namespace cairn::datasets
