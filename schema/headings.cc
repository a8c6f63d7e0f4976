#include "schema/headings.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cairn {

double TurnBetween(double a_rad, double b_rad) {
  return std::abs(std::remainder(a_rad - b_rad, 2 * std::numbers::pi));
}

bool FaceAlike(double a_rad, double b_rad) { return TurnBetween(a_rad, b_rad) <= std::numbers::pi / 2; }

bool AllFaceOneWay(std::span<const double> headings_rad) {
  double x = 0, y = 0;
  for (const double heading : headings_rad) {
    x += std::cos(heading);
    y += std::sin(heading);
  }
  const double mean = std::atan2(y, x);
  return std::ranges::all_of(headings_rad, [&](double heading) { return FaceAlike(heading, mean); });
}

}  // namespace cairn
