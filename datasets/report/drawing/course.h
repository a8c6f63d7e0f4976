// Which points of a line its course takes.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "schema/geometry.h"

namespace cairn::datasets::report {

// Indices of points, the first and the last among them, such that every other lies within `tolerance` of the
// straight line between its neighbours among them; with `times_s` (of each point, never backwards; else
// empty) within it of where somebody would be at its time who went from one to the next evenly, so that place
// and time can be read off. Douglas and Peucker 1973; with times Meratnia and de By 2004 (TD-TR).
std::vector<std::size_t> CourseOf(std::span<const Point> points, std::span<const double> times_s,
                                  double tolerance);

}  // namespace cairn::datasets::report
