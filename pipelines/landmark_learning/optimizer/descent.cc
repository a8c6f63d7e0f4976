#include "pipelines/landmark_learning/optimizer/descent.h"

#include <cmath>

#include "schema/error.h"

namespace cairn::landmark_learning {

void Descent::Step(const DescentRules& rules, const std::vector<double>& gradient,
                   std::vector<double>* weights) {
  CAIRN_DEMAND(gradient.size() == weights->size(), "a gradient by other weights");
  if (first.empty() && rules.method != Method::kGradient) first.assign(gradient.size(), 0.0F);
  if (second.empty() && rules.method == Method::kAdam) second.assign(gradient.size(), 0.0F);
  ++step;
  constexpr double kFirst = 0.9, kSecond = 0.999, kSmall = 1e-8;
  const double first_share = 1.0 - std::pow(kFirst, static_cast<double>(step));
  const double second_share = 1.0 - std::pow(kSecond, static_cast<double>(step));
  for (std::size_t i = 0; i < gradient.size(); ++i) {
    double& w = (*weights)[i];
    w -= rules.rate * rules.weight_decay * w;
    if (rules.method == Method::kGradient) {
      // [Thr98] eqs 38, 44
      w -= rules.rate * gradient[i];
    } else if (rules.method == Method::kMomentum) {
      // [Thr98] section 5.1.4: momentum
      first[i] = static_cast<float>(rules.momentum * first[i] - rules.rate * gradient[i]);
      w += first[i];
    } else {
      first[i] = static_cast<float>(kFirst * first[i] + (1.0 - kFirst) * gradient[i]);
      second[i] = static_cast<float>(kSecond * second[i] + (1.0 - kSecond) * gradient[i] * gradient[i]);
      w -= rules.rate * (first[i] / first_share) / (std::sqrt(second[i] / second_share) + kSmall);
    }
  }
}

}  // namespace cairn::landmark_learning
