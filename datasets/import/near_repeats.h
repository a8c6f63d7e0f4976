// Steps that stand in a log twice, once with fewer digits: two part files that overlap, written by two
// programs.
#pragma once

#include <string>

#include "datasets/import/log_rows.h"

namespace cairn::datasets {

// "at least 17 of 120 rows say the same as the row beside them, with other digits (the first: lines 41 and
// 42): …" where five and more such pairs follow each other, and the rows behind the pairs say something else;
// else empty. What is told so is left as it is: where a robot goes evenly, or a clock is coarse, steps one
// after the other may look like that.
std::string DoubtNearRepeats(const Odometry& odometry);

}  // namespace cairn::datasets
