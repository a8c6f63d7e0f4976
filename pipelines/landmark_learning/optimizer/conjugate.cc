#include "pipelines/landmark_learning/optimizer/conjugate.h"

#include <algorithm>
#include <cmath>

#include "schema/error.h"

namespace cairn::landmark_learning {
namespace {

// Over any two vectors of one length, in order.
template <class A, class B>
double Dot(const A& a, const B& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += static_cast<double>(a[i]) * static_cast<double>(b[i]);
  return sum;
}

}  // namespace

void Conjugate::Turn(double error, const std::vector<double>& of_gradient, double first_length) {
  start = error;
  const double slope_before = slope;
  const bool first = direction.empty();
  const bool keep = !first && failures == 0 && since_restart < static_cast<std::int64_t>(of_gradient.size());
  double beta = 0.0;
  if (const double before = first ? 0.0 : Dot(gradient, gradient); keep && before > 0.0)
    // [Thr98] sections 4.4.2 and 5.1.4: conjugate gradients, here by Polak and Ribiere
    beta = std::max(0.0, (Dot(of_gradient, of_gradient) - Dot(of_gradient, gradient)) / before);
  direction.resize(of_gradient.size(), 0.0F);
  for (std::size_t i = 0; i < direction.size(); ++i)
    direction[i] = static_cast<float>(beta * direction[i] - of_gradient[i]);
  slope = Dot(of_gradient, direction);
  if (!(slope < 0.0)) {
    beta = 0.0;
    for (std::size_t i = 0; i < direction.size(); ++i) direction[i] = static_cast<float>(-of_gradient[i]);
    slope = Dot(of_gradient, direction);
  }
  since_restart = beta > 0.0 ? since_restart + 1 : 0;
  const double norm = std::sqrt(Dot(direction, direction));
  if (first)
    length = norm > 0.0 ? first_length * std::sqrt(static_cast<double>(direction.size())) / norm : 0.0;
  else if (failures == 0 && slope < 0.0)
    // As much lower as the step before, were it straight.
    length *= std::clamp(slope_before / slope, 0.1, 10.0);
  gradient.assign(of_gradient.begin(), of_gradient.end());
}

double Conjugate::Choose(const std::vector<double>& errors) {
  CAIRN_DEMAND(errors.size() == kTried.size(), "errors of another line search");
  const auto best = std::ranges::min_element(errors);
  if (!(*best < start)) {
    ++failures;
    length *= kTried[0] * kTried[0];
    return 0.0;
  }
  failures = 0;
  length *= kTried[static_cast<std::size_t>(best - errors.begin())];
  return length;
}

std::vector<double> AlongLine(std::vector<double> weights, const std::vector<float>& direction,
                              double length) {
  CAIRN_DEMAND(direction.size() == weights.size(), "a line through other weights");
  for (std::size_t i = 0; i < weights.size(); ++i) weights[i] += length * direction[i];
  return weights;
}

}  // namespace cairn::landmark_learning
