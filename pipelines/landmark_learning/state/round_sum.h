// What the partials of a round add up to.
#pragma once

#include <vector>

#include "pipelines/pipeline.h"

namespace cairn::landmark_learning {

struct RoundSum {
  double error = 0.0, validation = 0.0;
  std::vector<double> gradient;  // of the error: by the weights that learn, or by the outputs
};

// Shares of `gradient` lie whole in `gradients`, those by outputs from their row `first` on.
// Throws InputError where one does not fit into `size` numbers.
RoundSum SumOf(Partials& partials, std::size_t size);

// The errors of a line search, one for each length: each partial is a share of one of them.
std::vector<double> SearchedErrors(Partials& partials, std::size_t lengths);

double Norm(const std::vector<double>& gradient);

}  // namespace cairn::landmark_learning
