// What the partials of a round add up to.
#pragma once

#include <vector>

#include "pipelines/pipeline.h"

namespace cairn::landmark_learning {

struct RoundSum {
  double error = 0.0, validation = 0.0;
  std::vector<double> gradient;
};

// Throws InputError where a gradient is not by so many parameters.
RoundSum SumOf(Partials& partials, std::size_t parameters);

double Norm(const std::vector<double>& gradient);

}  // namespace cairn::landmark_learning
