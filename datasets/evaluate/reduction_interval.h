// A confidence interval of an error reduction, by a bootstrap over what may be taken for independent.
#pragma once

#include <optional>
#include <vector>

#include "schema/rng.h"

namespace cairn::datasets {

// What a cluster of samples (a run, or a block of one) adds to both errors.
struct ErrorSums {
  double prior_m = 0, posterior_m = 0;
};

// 1 - sum posterior / sum prior ([Thr98] eq. 46); none where the prior errors are all zero.
std::optional<double> ReductionOf(const std::vector<ErrorSums>& clusters);

struct Interval {
  double low = 0, high = 0;
};

// 95%: the reduction plus or minus t times its standard error. That is the standard deviation of the
// reduction over `kResamples` sets of C clusters drawn with replacement, times sqrt(C / (C - 1)), and t is
// Student's with C - 1 degrees of freedom: a plain percentile interval is far too narrow for a handful of
// runs. Never above 1. None with fewer than two clusters.
std::optional<Interval> ReductionInterval(const std::vector<ErrorSums>& clusters, Rng rng);

inline constexpr int kResamples = 2000;

// Student's t, the 97.5% quantile; degrees >= 1. To 2e-4 relative.
double StudentT975(int degrees);

}  // namespace cairn::datasets
