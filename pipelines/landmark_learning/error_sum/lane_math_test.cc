#include "pipelines/landmark_learning/error_sum/lane_math.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace cairn::landmark_learning {
namespace {

// -0, then ever farther down, a multiple of no power of two.
template <class Real>
std::vector<Real> Arguments(double until) {
  std::vector<Real> x{Real(-0.0)};
  for (double at = -1e-6; at > until; at *= 1.0173) x.push_back(static_cast<Real>(at));
  while (x.size() % 8 != 0) x.push_back(x.back());
  return x;
}

template <class Real>
void ExpectExp(double until, double tolerance) {
  using L = Lanes<Real>;
  const auto x = Arguments<Real>(until);
  ASSERT_GT(x.size(), 900U);
  std::vector<Real> exp(x.size());
  for (std::size_t i = 0; i < x.size(); i += L::kCount) L::Store(&exp[i], ExpOfNegative<L>(L::Load(&x[i])));
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double expected = std::exp(static_cast<double>(x[i]));
    EXPECT_NEAR(exp[i], expected, tolerance * expected) << x[i];
    EXPECT_EQ(exp[i], ExpOfNegative<OneLane<Real>>(x[i])) << x[i];
  }
}

TEST(LaneMath, ExpIsThatOfTheLibraryToTwoLastPlacesWhateverTheWidth) {
  ExpectExp<float>(-86.0, 1.2e-7);
  ExpectExp<double>(-707.0, 4.5e-16);
}

template <class Real>
void ExpectSigmoid(double tolerance) {
  auto x = Arguments<Real>(-50.0);
  const std::size_t half = x.size();
  for (std::size_t i = 0; i < half; ++i) x.push_back(-x[i]);
  x.push_back(Real(0.3));  // one that fills no register
  auto sigmoid = x;
  SigmoidOfAll(static_cast<int>(x.size()), sigmoid.data());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double expected = 1.0 / (1.0 + std::exp(-static_cast<double>(x[i])));
    EXPECT_NEAR(sigmoid[i], expected, tolerance * expected) << x[i];
    EXPECT_EQ(sigmoid[i], Sigmoid<OneLane<Real>>(x[i])) << x[i];
  }
}

TEST(LaneMath, TheSigmoidIsExactToLastPlacesAndEndsAtZeroAndOne) {
  ExpectSigmoid<float>(2.5e-7);
  ExpectSigmoid<double>(7e-16);
  EXPECT_EQ(Sigmoid<OneLane<float>>(-1000.0F), 0.0F);
  EXPECT_EQ(Sigmoid<OneLane<float>>(1000.0F), 1.0F);
  EXPECT_EQ(Sigmoid<OneLane<double>>(-1000.0), 0.0);
  EXPECT_EQ(Sigmoid<OneLane<double>>(1000.0), 1.0);
}

}  // namespace
}  // namespace cairn::landmark_learning
