// A measure over independent seeds: its mean and Student's 95% interval.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace cairn::datasets {

struct OverSeeds {
  double mean = 0;
  std::optional<double> half;  // of the interval; none of a single value

  double low() const { return mean - half.value_or(0); }
  double high() const { return mean + half.value_or(0); }
};

// NaN where there is no value.
OverSeeds MeanOverSeeds(const std::vector<double>& values);

// "41.7 +- 2.5" percent of a share; "41.7" of a single seed.
std::string PercentText(const OverSeeds& share);

}  // namespace cairn::datasets
