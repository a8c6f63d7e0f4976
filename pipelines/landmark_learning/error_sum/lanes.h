// Registers whose lanes hold different features, samples or units, never terms of one sum: so the order of
// addition does not depend on how wide they are, and the bits are those of the plain loop.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <type_traits>

#if defined(__AVX2__) && defined(__FMA__)
#include <immintrin.h>
#endif

namespace cairn::landmark_learning {

// The bits of a Real as a number, and of its mantissa.
template <class Real>
using BitsOf = std::conditional_t<sizeof(Real) == 4, std::uint32_t, std::uint64_t>;
template <class Real>
inline constexpr int kMantissaBits = sizeof(Real) == 4 ? 23 : 52;

// One number at a time.
template <class Real>
struct OneLane {
  static constexpr int kCount = 1;
  using Number = Real;
  using Register = Real;
  static Register Load(const Real* from) { return *from; }
  static Register Broadcast(Real value) { return value; }
  static Register Add(Register a, Register b) { return a + b; }
  static Register Sub(Register a, Register b) { return a - b; }
  static Register Mul(Register a, Register b) { return a * b; }
  static Register Div(Register a, Register b) { return a / b; }
  static Register Fma(Register a, Register b, Register sum) { return std::fma(a, b, sum); }
  static Register Sqrt(Register a) { return std::sqrt(a); }
  static Register Abs(Register a) { return std::abs(a); }
  static Register Min(Register a, Register b) { return a < b ? a : b; }
  // `value` where a <= b, else 0.
  static Register IfAtMost(Register a, Register b, Register value) { return a <= b ? value : Real(0); }
  static Register IfLess(Register a, Register b, Register value) { return a < b ? value : Real(0); }
  // value * 2^k, where k stands in the last bits of `power`'s mantissa; no lane may leave the normal range.
  static Register Scale(Register value, Register power) {
    using Bits = BitsOf<Real>;
    return std::bit_cast<Real>(std::bit_cast<Bits>(value) +
                               (std::bit_cast<Bits>(power) << kMantissaBits<Real>));
  }
  static void Store(Real* to, Register value) { *to = value; }
};

template <class Real>
struct Lanes : OneLane<Real> {};

#if defined(__AVX2__) && defined(__FMA__)
template <>
struct Lanes<float> {
  static constexpr int kCount = 8;
  using Number = float;
  using Register = __m256;
  static Register Load(const float* from) { return _mm256_loadu_ps(from); }
  static Register Broadcast(float value) { return _mm256_set1_ps(value); }
  static Register Add(Register a, Register b) { return _mm256_add_ps(a, b); }
  static Register Sub(Register a, Register b) { return _mm256_sub_ps(a, b); }
  static Register Mul(Register a, Register b) { return _mm256_mul_ps(a, b); }
  static Register Div(Register a, Register b) { return _mm256_div_ps(a, b); }
  static Register Fma(Register a, Register b, Register sum) { return _mm256_fmadd_ps(a, b, sum); }
  static Register Sqrt(Register a) { return _mm256_sqrt_ps(a); }
  static Register Abs(Register a) { return _mm256_andnot_ps(_mm256_set1_ps(-0.0F), a); }
  static Register Min(Register a, Register b) { return _mm256_min_ps(a, b); }
  static Register IfAtMost(Register a, Register b, Register value) {
    return _mm256_and_ps(_mm256_cmp_ps(a, b, _CMP_LE_OQ), value);
  }
  static Register IfLess(Register a, Register b, Register value) {
    return _mm256_and_ps(_mm256_cmp_ps(a, b, _CMP_LT_OQ), value);
  }
  static Register Scale(Register value, Register power) {
    const __m256i exponent = _mm256_slli_epi32(_mm256_castps_si256(power), kMantissaBits<float>);
    return _mm256_castsi256_ps(_mm256_add_epi32(_mm256_castps_si256(value), exponent));
  }
  static void Store(float* to, Register value) { _mm256_storeu_ps(to, value); }
};

template <>
struct Lanes<double> {
  static constexpr int kCount = 4;
  using Number = double;
  using Register = __m256d;
  static Register Load(const double* from) { return _mm256_loadu_pd(from); }
  static Register Broadcast(double value) { return _mm256_set1_pd(value); }
  static Register Add(Register a, Register b) { return _mm256_add_pd(a, b); }
  static Register Sub(Register a, Register b) { return _mm256_sub_pd(a, b); }
  static Register Mul(Register a, Register b) { return _mm256_mul_pd(a, b); }
  static Register Div(Register a, Register b) { return _mm256_div_pd(a, b); }
  static Register Fma(Register a, Register b, Register sum) { return _mm256_fmadd_pd(a, b, sum); }
  static Register Sqrt(Register a) { return _mm256_sqrt_pd(a); }
  static Register Abs(Register a) { return _mm256_andnot_pd(_mm256_set1_pd(-0.0), a); }
  static Register Min(Register a, Register b) { return _mm256_min_pd(a, b); }
  static Register IfAtMost(Register a, Register b, Register value) {
    return _mm256_and_pd(_mm256_cmp_pd(a, b, _CMP_LE_OQ), value);
  }
  static Register IfLess(Register a, Register b, Register value) {
    return _mm256_and_pd(_mm256_cmp_pd(a, b, _CMP_LT_OQ), value);
  }
  static Register Scale(Register value, Register power) {
    const __m256i exponent = _mm256_slli_epi64(_mm256_castpd_si256(power), kMantissaBits<double>);
    return _mm256_castsi256_pd(_mm256_add_epi64(_mm256_castpd_si256(value), exponent));
  }
  static void Store(double* to, Register value) { _mm256_storeu_pd(to, value); }
};
#endif

}  // namespace cairn::landmark_learning
