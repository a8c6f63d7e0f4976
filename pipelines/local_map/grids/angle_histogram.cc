#include "pipelines/local_map/grids/angle_histogram.h"

#include <algorithm>

namespace cairn::local_map {

AnglePeak PeakOf(const AngleHistogram& histogram, double period_rad) {
  const auto& bin = histogram.bin;
  const auto at = [&](unsigned k) { return static_cast<double>(bin[k % kAngleBins]); };
  AnglePeak peak;
  peak.weight = histogram.Total();
  if (!(peak.weight > 0)) return peak;
  unsigned best = 0;
  double most = -1;
  for (unsigned k = 0; k < kAngleBins; ++k) {
    const double weight = at(k + kAngleBins - 1) + 2 * at(k) + at(k + 1);
    if (weight <= most) continue;
    most = weight;
    best = k;
  }
  const double before = at(best + kAngleBins - 1), after = at(best + 1), three = before + at(best) + after;
  const double common = *std::min_element(bin.begin(), bin.end());
  const double apart = three - 3 * common;
  const double beside = apart > 0 ? (after - before) / apart : 0;
  peak.angle_rad = ModuloAngle((best + beside) * period_rad / kAngleBins, period_rad);
  peak.strength = three / peak.weight;
  return peak;
}

}  // namespace cairn::local_map
