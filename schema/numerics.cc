#include "schema/numerics.h"

#include <Eigen/Core>
#include <cfenv>
#include <cmath>
#include <cstring>
#include <span>
#include <vector>

#include "schema/rng.h"

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace cairn {
namespace {

template <class T>
void AddBits(Hasher& hasher, const std::vector<T>& values) {
  hasher.Add(std::as_bytes(std::span(values)));
}

// Arguments over many magnitudes, drawn when the program runs, so that the compiler cannot compute the
// answers.
std::vector<double> Arguments() {
  Rng rng(20240229, 1, 2);
  std::vector<double> values(400);
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = rng.Normal() * std::ldexp(1.0, static_cast<int>(i % 24) - 12);
  }
  return values;
}

std::vector<double> Elementary(const std::vector<double>& x) {
  std::vector<double> y;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double a = x[i];
    const double b = x[x.size() - 1 - i];
    const double positive = std::abs(a);
    for (const double value :
         {std::exp(a / 8), std::log(positive), std::sin(a), std::cos(a), std::atan2(a, b), std::tanh(a),
          std::pow(positive, b / 64), std::sqrt(positive), std::fma(a, b, a), std::expm1(a / 8),
          std::log1p(positive), std::hypot(a, b)}) {
      y.push_back(value);
    }
  }
  return y;
}

std::vector<float> Singles(const std::vector<double>& x) {
  std::vector<float> y;
  float dot = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const auto a = static_cast<float>(x[i]);
    dot += a * static_cast<float>(x[x.size() - 1 - i]);
    for (const float value : {dot, std::exp(a / 8), std::log(std::abs(a)), std::sin(a), std::cos(a),
                              std::tanh(a), a * 1e-38F, std::fma(a, dot, a)}) {
      y.push_back(value);
    }
  }
  return y;
}

// Large enough that Eigen cuts it into blocks.
std::vector<float> Product() {
  constexpr int kSize = 160;
  Rng rng(7);
  Eigen::MatrixXf a(kSize, kSize);
  for (Eigen::Index i = 0; i < a.size(); ++i) a.data()[i] = static_cast<float>(rng.Normal());
  const Eigen::MatrixXf square = a * a;
  return {square.data(), square.data() + square.size()};
}

}  // namespace

void FixNumericsOfProcess() { Eigen::setCpuCacheSizes(32 * 1024, 512 * 1024, 4 * 1024 * 1024); }

void FixNumericsOfThread() {
  std::fesetenv(FE_DFL_ENV);
#if defined(__x86_64__)
  _mm_setcsr(
      0x1F80);  // all exceptions masked, round to nearest, neither flush-to-zero nor denormals-are-zero
#endif
}

Hash NumericSelfTest() {
  const std::vector<double> arguments = Arguments();
  Hasher hasher;
  AddBits(hasher, arguments);
  AddBits(hasher, Elementary(arguments));
  AddBits(hasher, Singles(arguments));
  AddBits(hasher, Product());
  return hasher.Finish();
}

}  // namespace cairn
