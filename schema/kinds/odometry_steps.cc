#include "schema/kinds/odometry_steps.h"

#include <cmath>

namespace cairn {

double ChordOfArc(double way_m, double turn_rad) {
  return turn_rad == 0 ? way_m : way_m * std::sin(turn_rad / 2) / (turn_rad / 2);
}

bool IsStep(const Walked<double>& time_s, const Walked<double>& turn_rad, const Walked<double>& forward_m,
            std::size_t i) {
  const bool alone =
      (i == 0 || time_s[i - 1] != time_s[i]) && (i + 1 == time_s.size() || time_s[i + 1] != time_s[i]);
  return alone && turn_rad[i] != 0 && forward_m[i] != 0;
}

double HalfStep_m(const Walked<double>& time_s, const Walked<double>& turn_rad,
                  const Walked<double>& forward_m) {
  double sum = 0, weights = 0;
  for (std::size_t i = 0; i < time_s.size(); ++i) {
    const double weight = turn_rad[i] * turn_rad[i];
    weights += weight;
    if (IsStep(time_s, turn_rad, forward_m, i)) sum += weight * forward_m[i] / 2;
  }
  return weights > 0 ? sum / weights : 0;
}

}  // namespace cairn
