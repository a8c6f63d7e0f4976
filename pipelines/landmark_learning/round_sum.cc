#include "pipelines/landmark_learning/round_sum.h"

#include <cmath>

namespace cairn::landmark_learning {

RoundSum SumOf(Partials& partials, std::size_t parameters) {
  RoundSum sum;
  sum.gradient.assign(parameters, 0.0);
  for (std::size_t i = 0; i < partials.size(); ++i) {
    const BlobPtr partial = partials.Get(i);
    if (partial->Has("validation")) {
      sum.validation += partial->Scalar<double>("validation");
      continue;
    }
    sum.error += partial->Scalar<double>("error");
    const auto gradient = partial->Get<float>("gradient");
    if (gradient.size() != parameters) throw InputError("a partial's gradient is by other weights");
    for (std::size_t p = 0; p < parameters; ++p) sum.gradient[p] += gradient[p];
  }
  return sum;
}

double Norm(const std::vector<double>& gradient) {
  double squares = 0.0;
  for (const double slope : gradient) squares += slope * slope;
  return std::sqrt(squares);
}

}  // namespace cairn::landmark_learning
