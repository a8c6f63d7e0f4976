// P(f | xi), the map of features ([Thr98] section 5.1.6), and what a sensation says of the positions in it.
#pragma once

#include <vector>

#include "pipelines/localization/look.h"
#include "schema/rng.h"

namespace cairn::localization {

// P(f_i = 1 | xi): the mean output of `samples`, the training samples nearest to xi, [features], and
// `prior_count` samples more of either outcome, so that a handful of samples never rules anything out.
// `output`: [samples][features] in [0, 1].
std::vector<double> MeanFeatures(const std::vector<std::size_t>& samples, const std::vector<double>& output,
                                 std::size_t features, double prior_count);

// f of a sensation whose bits are 1 with probability `output`, drawn ([Thr98] eqs 32, 33): zeros and ones.
std::vector<double> Drawn(const std::vector<double>& output, Rng& rng);

// P(f | xi) of each position: prod_i of P(f_i | xi) over the bits of `group`. `feature`: zeros and ones, or
// probabilities of ones, over which the expectation is taken: sum_f P(f | s) P(f | xi); of all bits. `map`:
// [positions][features]. Raised to the power of `trust`: sensations that follow each other are not
// independent, as table 1 holds them to be.
std::vector<double> Likelihood(const std::vector<double>& map, const std::vector<double>& feature,
                               const FeatureGroup& group, double trust);

}  // namespace cairn::localization
