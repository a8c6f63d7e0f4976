// Whether odometry begins anew within a log: its driver was started again, and from one row to the next the
// robot is where it began.
#pragma once

#include <optional>

#include "datasets/common/unit_doubts.h"
#include "schema/walked.h"

namespace cairn::datasets {

// Of odometry's poses, columns of one length, times in order: the first row that
// - goes a metre or more, several times as fast as usual, to where the track began, or to zero, or does so in
//   a pause between rows; or
// - goes some metres elsewhere so fast;
// each between rows that do not, and neither of which takes it back.
std::optional<UnitDoubt> DoubtRestart(const Walked<double>& time_s, const Walked<double>& x_m,
                                      const Walked<double>& y_m, const Walked<double>& heading_rad);

}  // namespace cairn::datasets
