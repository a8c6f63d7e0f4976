#include "pipelines/landmark_learning/state/round_sum.h"

#include <cmath>

namespace cairn::landmark_learning {

RoundSum SumOf(Partials& partials, std::size_t size) {
  RoundSum sum;
  sum.gradient.assign(size, 0.0);
  for (std::size_t i = 0; i < partials.size(); ++i) {
    const BlobPtr partial = partials.Get(i);
    if (partial->Has("validation")) {
      sum.validation += partial->Scalar<double>("validation");
      continue;
    }
    sum.error += partial->Scalar<double>("error");
    const auto gradient = partial->Get<float>("gradient");
    const auto first =
        partial->Has("first") ? static_cast<std::size_t>(partial->Scalar<std::int64_t>("first")) : 0;
    if (first > size || gradient.size() > size - first)
      throw InputError("a partial's gradients are by other weights or samples");
    for (std::size_t p = 0; p < gradient.size(); ++p) sum.gradient[first + p] += gradient[p];
  }
  return sum;
}

std::vector<double> SearchedErrors(Partials& partials, std::size_t lengths) {
  std::vector<double> errors(lengths, 0.0);
  for (std::size_t i = 0; i < partials.size(); ++i) {
    const BlobPtr partial = partials.Get(i);
    errors.at(static_cast<std::size_t>(partial->Scalar<std::int64_t>("length"))) +=
        partial->Scalar<double>("error");
  }
  return errors;
}

double Norm(const std::vector<double>& gradient) {
  double squares = 0.0;
  for (const double slope : gradient) squares += slope * slope;
  return std::sqrt(squares);
}

}  // namespace cairn::landmark_learning
