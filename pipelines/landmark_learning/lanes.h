// Registers whose lanes hold different features, never terms of one sum: so the order of addition does not
// depend on how wide they are, and the bits are those of the plain loop.
#pragma once

#include <cmath>

#if defined(__AVX2__) && defined(__FMA__)
#include <immintrin.h>
#endif

namespace cairn::landmark_learning {

// One number at a time.
template <class Real>
struct OneLane {
  static constexpr int kCount = 1;
  using Register = Real;
  static Register Load(const Real* from) { return *from; }
  static Register Broadcast(Real value) { return value; }
  static Register Fma(Register a, Register b, Register sum) { return std::fma(a, b, sum); }
  static void Store(Real* to, Register value) { *to = value; }
};

template <class Real>
struct Lanes : OneLane<Real> {};

#if defined(__AVX2__) && defined(__FMA__)
template <>
struct Lanes<float> {
  static constexpr int kCount = 8;
  using Register = __m256;
  static Register Load(const float* from) { return _mm256_loadu_ps(from); }
  static Register Broadcast(float value) { return _mm256_set1_ps(value); }
  static Register Fma(Register a, Register b, Register sum) { return _mm256_fmadd_ps(a, b, sum); }
  static void Store(float* to, Register value) { _mm256_storeu_ps(to, value); }
};

template <>
struct Lanes<double> {
  static constexpr int kCount = 4;
  using Register = __m256d;
  static Register Load(const double* from) { return _mm256_loadu_pd(from); }
  static Register Broadcast(double value) { return _mm256_set1_pd(value); }
  static Register Fma(Register a, Register b, Register sum) { return _mm256_fmadd_pd(a, b, sum); }
  static void Store(double* to, Register value) { _mm256_storeu_pd(to, value); }
};
#endif

}  // namespace cairn::landmark_learning
