#include "datasets/reproduce/over_seeds.h"

#include <cmath>

#include "datasets/evaluate/reduction_interval.h"
#include "datasets/reproduce/figure_panels.h"

namespace cairn::datasets {

OverSeeds MeanOverSeeds(const std::vector<double>& values) {
  const auto count = static_cast<double>(values.size());
  OverSeeds over{values.empty() ? NAN : 0, {}};
  for (const double value : values) over.mean += value / count;
  if (values.size() < 2) return over;
  double squares = 0;
  for (const double value : values) squares += (value - over.mean) * (value - over.mean);
  over.half = StudentT975(static_cast<int>(values.size()) - 1) * std::sqrt(squares / (count - 1) / count);
  return over;
}

std::string PercentText(const OverSeeds& share) {
  return share.half ? Say("%.1f +- %.1f", 100 * share.mean, 100 * *share.half)
                    : Say("%.1f", 100 * share.mean);
}

}  // namespace cairn::datasets
