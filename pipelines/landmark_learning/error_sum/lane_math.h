// exp and the sigmoid of all lanes of a register, of nothing but additions, multiplications and fma: the same
// bits on every processor and whatever libm is there.
#pragma once

#include <array>
#include <numbers>

#include "pipelines/landmark_learning/error_sum/lanes.h"

namespace cairn::landmark_learning {

// exp(x) for x <= 0, to 2 units in the last place; below kLeast (about -87 for float, -708 for double) that
// of kLeast.
template <class Real>
inline constexpr Real kLeastExponent = sizeof(Real) == 4 ? Real(-86.5) : Real(-707.5);

template <class L>
typename L::Register ExpOfNegative(typename L::Register x) {
  using Real = typename L::Number;
  // exp(x) = 2^k exp(r), |r| <= ln 2 / 2: k by adding a number whose last bit is worth one.
  constexpr Real kRounder = Real(1.5) * static_cast<Real>(BitsOf<Real>{1} << kMantissaBits<Real>);
  constexpr Real kLn2 = static_cast<Real>(std::numbers::ln2);
  constexpr Real kLn2Rest =
      sizeof(Real) == 4 ? static_cast<Real>(std::numbers::ln2 - static_cast<double>(kLn2))
                        : static_cast<Real>(2.3190468138462996e-17);  // ln 2 - the double nearest to it
  constexpr int kDegree = sizeof(Real) == 4 ? 7 : 13;                 // Taylor's rest: 5e-9, 5e-18
  constexpr auto kInverseFactorials = [] {
    std::array<double, kDegree + 1> inverse{1.0};
    double factorial = 1.0;
    for (int i = 1; i <= kDegree; ++i) inverse[static_cast<std::size_t>(i)] = 1.0 / (factorial *= i);
    return inverse;
  }();
  const auto least = L::Broadcast(kLeastExponent<Real>), zero = L::Broadcast(Real(0));
  const auto bounded = L::Sub(zero, L::Min(L::Sub(zero, least), L::Sub(zero, x)));
  const auto rounder = L::Broadcast(kRounder);
  const auto power = L::Fma(bounded, L::Broadcast(static_cast<Real>(std::numbers::log2e)), rounder);
  const auto minus_k = L::Sub(rounder, power);
  auto r = L::Fma(minus_k, L::Broadcast(kLn2), bounded);
  r = L::Fma(minus_k, L::Broadcast(kLn2Rest), r);
  auto sum = L::Broadcast(static_cast<Real>(kInverseFactorials[kDegree]));
  for (int i = kDegree - 1; i >= 0; --i)
    sum = L::Fma(sum, r, L::Broadcast(static_cast<Real>(kInverseFactorials[static_cast<std::size_t>(i)])));
  return L::Scale(sum, power);
}

// 1 / (1 + exp(-x)); exactly 0 and 1 far out. With e = exp(-|x|) it is 1 / (1 + e) above zero and e / (1 + e)
// below.
template <class L>
typename L::Register Sigmoid(typename L::Register x) {
  using Real = typename L::Number;
  const auto zero = L::Broadcast(Real(0)), one = L::Broadcast(Real(1));
  const auto minus = L::Sub(zero, L::Abs(x));
  const auto e = L::IfLess(L::Broadcast(kLeastExponent<Real>), minus, ExpOfNegative<L>(minus));
  const auto share = L::Div(one, L::Add(one, e));
  return L::Add(L::IfAtMost(zero, x, share), L::IfLess(x, zero, L::Mul(e, share)));
}

// Sigmoid of n numbers in place.
template <class Real>
void SigmoidOfAll(int n, Real* x) {
  using L = Lanes<Real>;
  int i = 0;
  for (; i + L::kCount <= n; i += L::kCount) L::Store(x + i, Sigmoid<L>(L::Load(x + i)));
  for (; i < n; ++i) x[i] = Sigmoid<OneLane<Real>>(x[i]);
}

}  // namespace cairn::landmark_learning
