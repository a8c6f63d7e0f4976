#include "datasets/evaluate/reduction_interval.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace cairn::datasets {
namespace {

double StandardDeviation(const std::vector<double>& values) {
  double mean = 0, squares = 0;
  for (const double value : values) mean += value / static_cast<double>(values.size());
  for (const double value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares / static_cast<double>(values.size()));
}

}  // namespace

std::optional<double> ReductionOf(const std::vector<ErrorSums>& clusters) {
  ErrorSums all;
  for (const ErrorSums& cluster : clusters) {
    all.prior_m += cluster.prior_m;
    all.posterior_m += cluster.posterior_m;
  }
  if (all.prior_m <= 0) return std::nullopt;
  // [Thr98] eq. 46
  return 1 - all.posterior_m / all.prior_m;
}

double StudentT975(int degrees) {
  constexpr std::array kExact = {12.7062, 4.30265, 3.18245, 2.77645, 2.57058,
                                 2.44691, 2.36462, 2.30600, 2.26216};
  if (degrees <= static_cast<int>(kExact.size())) return kExact[static_cast<std::size_t>(degrees - 1)];
  // M. Abramowitz and I. A. Stegun, Handbook of mathematical functions, 26.7.5.
  constexpr double z = 1.959963985, z3 = z * z * z, z5 = z3 * z * z, z7 = z5 * z * z;
  const double d = degrees;
  return z + (z3 + z) / (4 * d) + (5 * z5 + 16 * z3 + 3 * z) / (96 * d * d) +
         (3 * z7 + 19 * z5 + 17 * z3 - 15 * z) / (384 * d * d * d);
}

std::optional<Interval> ReductionInterval(const std::vector<ErrorSums>& clusters, Rng rng) {
  const std::optional<double> reduction = ReductionOf(clusters);
  if (clusters.size() < 2 || !reduction) return std::nullopt;
  std::vector<double> drawn;
  std::vector<ErrorSums> resample(clusters.size());
  for (int i = 0; i < kResamples; ++i) {
    for (ErrorSums& cluster : resample) cluster = clusters[rng.Below(clusters.size())];
    if (const auto one = ReductionOf(resample)) drawn.push_back(*one);
  }
  const auto count = static_cast<double>(clusters.size());
  const double error = StandardDeviation(drawn) * std::sqrt(count / (count - 1));
  const double half = StudentT975(static_cast<int>(clusters.size()) - 1) * error;
  return Interval{*reduction - half, std::min(1.0, *reduction + half)};
}

}  // namespace cairn::datasets
