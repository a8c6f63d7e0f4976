// Rows of odometry that turn and go at once: steps. By the format a robot turns first and then goes; one that
// turns while it goes drives an arc.
#pragma once

#include <cstddef>

#include "schema/kinds/log.h"
#include "schema/walked.h"

namespace cairn {

// The straight way from one end of an arc to the other; the arc is `way_m` long and turns by `turn_rad`.
double ChordOfArc(double way_m, double turn_rad);

// Whether row `i` is all that its time says, and both turns and goes. An arc that was taken apart, half of
// the turn before its way and half after it, has two rows of one time.
bool IsStep(const Walked<double>& time_s, const Walked<double>& turn_rad, const Walked<double>& forward_m,
            std::size_t i);

// Half of the way of a step, in the mean over all turns, each weighing as its square; 0: there are no steps.
// Where steps are arcs, dead reckoning that turns first shows a sensor so far behind where it is.
double HalfStep_m(const Walked<double>& time_s, const Walked<double>& turn_rad,
                  const Walked<double>& forward_m);
inline double HalfStep_m(const kinds::Log::Odometry& odometry) {
  return HalfStep_m(odometry.time_s.values(), odometry.turn_rad.values(), odometry.forward_m.values());
}

}  // namespace cairn
