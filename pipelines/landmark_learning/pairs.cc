#include "pipelines/landmark_learning/pairs.h"

#include <algorithm>
#include <cmath>

namespace cairn::landmark_learning {
namespace {

// Relative to a point near by, so that float keeps what double has.
template <class Real>
std::vector<Real> From(const std::vector<double>& values, const Range& range, double origin) {
  std::vector<Real> relative(static_cast<std::size_t>(range.size()));
  for (int k = range.first; k < range.end; ++k)
    relative[static_cast<std::size_t>(k - range.first)] =
        static_cast<Real>(values[static_cast<std::size_t>(k)] - origin);
  return relative;
}

template <class Real>
void FillBelief(const Belief& belief, int n, const Real* distance, Real* row) {
  const auto reach = static_cast<Real>(belief.ReachM());
  if (belief.shape == BeliefShape::kUniform) {
    for (int k = 0; k < n; ++k) row[k] = distance[k] <= reach ? Real(1) : Real(0);
    return;
  }
  const auto scale = static_cast<Real>(-0.5 / (belief.width_m * belief.width_m));
  for (int k = 0; k < n; ++k)
    row[k] = distance[k] <= reach ? std::exp(scale * distance[k] * distance[k]) : Real(0);
}

double Gap(const std::vector<double>& of_a, const Range& a, const std::vector<double>& of_b, const Range& b) {
  const auto [a_low, a_high] = std::minmax_element(of_a.begin() + a.first, of_a.begin() + a.end);
  const auto [b_low, b_high] = std::minmax_element(of_b.begin() + b.first, of_b.begin() + b.end);
  return std::max({0.0, *b_low - *a_high, *a_low - *b_high});
}

}  // namespace

template <class Real>
void Pairs::Fill(const Range& truths, const Range& samples, Real* belief, Real* weighted) const {
  const int n = samples.size();
  const auto first = static_cast<std::size_t>(truths.first);
  const double x0 = true_.x_m[first], y0 = true_.y_m[first], along0 = true_.along_m[first];
  const auto x = From<Real>(samples_.x_m, samples, x0), y = From<Real>(samples_.y_m, samples, y0);
  const auto along = From<Real>(samples_.along_m, samples, along0);
  std::vector<Real> distance(static_cast<std::size_t>(n));
  for (int a = truths.first; a < truths.end; ++a, belief += n, weighted += n) {
    const auto at = static_cast<std::size_t>(a);
    const auto xa = static_cast<Real>(true_.x_m[at] - x0), ya = static_cast<Real>(true_.y_m[at] - y0);
    for (int k = 0; k < n; ++k) {
      const Real dx = x[k] - xa, dy = y[k] - ya;
      distance[k] = std::sqrt(std::fma(dx, dx, dy * dy));
    }
    FillBelief(belief_, n, distance.data(), belief);
    if (error_ == ErrorKind::kDistance) {
      for (int k = 0; k < n; ++k) weighted[k] = belief[k] * distance[k];
    } else if (error_ == ErrorKind::kSquaredDistance) {
      for (int k = 0; k < n; ++k) weighted[k] = belief[k] * (distance[k] * distance[k]);
    } else {
      const auto here = static_cast<Real>(true_.along_m[at] - along0);
      for (int k = 0; k < n; ++k) weighted[k] = belief[k] * std::abs(along[k] - here);
    }
  }
}

bool Pairs::Reaches(const Range& truths, const Range& samples) const {
  const double dx = Gap(true_.x_m, truths, samples_.x_m, samples);
  const double dy = Gap(true_.y_m, truths, samples_.y_m, samples);
  return std::hypot(dx, dy) <= belief_.ReachM() * (1.0 + 1e-6);
}

template void Pairs::Fill(const Range&, const Range&, float*, float*) const;
template void Pairs::Fill(const Range&, const Range&, double*, double*) const;

}  // namespace cairn::landmark_learning
