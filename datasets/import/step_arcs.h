// Steps of a robot that turns while it goes.
#pragma once

#include <string>

#include "datasets/import/log_rows.h"

namespace cairn::datasets {

// Takes each row for an arc that was driven evenly since the row before: of a piece of it half of the turn
// comes before the chord and half after, so that it becomes two rows of the same time, (turn/2, chord) and
// (turn/2, 0), as a velocity's row does. An arc is cut into pieces that turn so little that what is seen
// between two rows is seen from the right heading.
void TakeStepsAsArcs(Odometry* odometry);

// A warning where rows turn and go so far at once that it matters to any map which of both comes first; what
// is less the observations show, where they can (common/arc_doubts.h). Empty: none.
std::string DoubtLongSteps(const Odometry& odometry);

}  // namespace cairn::datasets
