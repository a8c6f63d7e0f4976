// Pseudo-patterns ([Thr98] section 4.4.2, item 3): one computation of dE/dg gives targets for the outputs,
// and each network is fitted to its own by many steps of ordinary backpropagation.
#pragma once

#include <cstdint>
#include <vector>

#include "pipelines/landmark_learning/networks/networks.h"
#include "pipelines/landmark_learning/optimizer/descent.h"
#include "pipelines/pipeline.h"

namespace cairn::landmark_learning {

// [Thr98] eq. 45, which as printed has E / g where the derivative is meant: g - `step` dE/dg, but within (0,
// 1). `slope`: that of the error summed over the true positions, so that a target does not depend on how many
// there are.
float PatternTarget(float g, double step, double slope);

// `steps` steps of one network down the gradient of the mean over the rows of (g - target)^2 / 2, by `rules`
// from rest. `weights`: of a network of `shape`; `inputs`: [rows][inputs]. Returns the weights.
std::vector<double> FitPatterns(const NetworkShape& shape, std::vector<double> weights, const float* inputs,
                                const std::vector<float>& target, const DescentRules& rules,
                                std::int64_t steps, Progress& progress);

}  // namespace cairn::landmark_learning
