// Which way things face: angles counter-clockwise from x.
#pragma once

#include <span>

namespace cairn {

// Between two headings, from 0 to pi.
double TurnBetween(double a_rad, double b_rad);

// Whether they point the same way rather than against each other: at most 90 degrees apart.
bool FaceAlike(double a_rad, double b_rad);

// Whether each is at most 90 degrees from their mean direction; true of none.
bool AllFaceOneWay(std::span<const double> headings_rad);

}  // namespace cairn
