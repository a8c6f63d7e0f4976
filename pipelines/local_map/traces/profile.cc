#include "pipelines/local_map/traces/profile.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace cairn::local_map {

Profile::Profile(double step_m, double reach_m)
    : step_m_(step_m), reach_(std::clamp(static_cast<int>(std::ceil(reach_m / step_m)), 1, kReach)) {}

double Profile::At(double at_m) const {
  const double at = std::clamp(at_m / step_m_, static_cast<double>(-reach_), static_cast<double>(reach_));
  const int below = std::min(static_cast<int>(std::floor(at)), reach_ - 1);
  const double share = at - below;
  return (1 - share) * (*this)[below] + share * (*this)[below + 1];
}

Peak Profile::FindPeak(double sharpness) const {
  int best = 0;  // of equal values the one nearest to the initial position
  for (int distance = 1; distance <= reach_; ++distance)
    for (const int step : {-distance, distance})
      if ((*this)[step] > (*this)[best] + 1e-9) best = step;
  Peak peak{best * step_m_, (*this)[best], 0, std::abs(best) < reach_};
  if (peak.inside) peak.at_m += step_m_ * Vertex((*this)[best - 1], (*this)[best], (*this)[best + 1]);
  constexpr double kFlat = 0.5;
  double mass = 0, spread = 0;
  for (int step = -reach_; step <= reach_; ++step) {
    const double weight = std::exp(sharpness * ((*this)[step] - peak.value)),
                 off = step * step_m_ - peak.at_m;
    mass += weight;
    spread += weight * off * off;
  }
  peak.sd_m = std::sqrt(spread / mass);
  // A flat profile gives reach / sqrt(3) and more. From half of that on, errors were far beyond it too often.
  if (peak.sd_m > kFlat * reach_ * step_m_ / std::numbers::sqrt3)
    peak.sd_m = std::numeric_limits<double>::infinity();
  return peak;
}

double Vertex(double before, double middle, double after) {
  const double bend = 2 * middle - before - after;
  return bend > 0 ? std::clamp(0.5 * (after - before) / bend, -0.5, 0.5) : 0;
}

}  // namespace cairn::local_map
