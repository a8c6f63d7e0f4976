#include "pipelines/local_map/angle_histogram.h"

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
    const double three = at(k + kAngleBins - 1) + at(k) + at(k + 1);
    if (three > most) {
      most = three;
      best = k;
    }
  }
  const double common = *std::min_element(bin.begin(), bin.end());
  const double apart = most - 3 * common;
  const double step = period_rad / kAngleBins;
  const double beside = apart > 0 ? (at(best + 1) - at(best + kAngleBins - 1)) / apart : 0;
  peak.angle_rad = ModuloAngle((best + beside) * step, period_rad);
  peak.strength = most / peak.weight;
  return peak;
}

}  // namespace cairn::local_map
