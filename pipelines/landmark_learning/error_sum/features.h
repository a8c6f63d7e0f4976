// Stochastic binary features: n networks give g_i(s) = P(f_i = 1 | s), and a feature vector f in {0, 1}^n
// comes with P(f | s) = prod_i P(f_i | s): [Thr98] eqs 32 and 33.
#pragma once

#include <cstddef>
#include <vector>

namespace cairn::landmark_learning {

inline constexpr int kMostNetworks = 12;  // P(f | s) of a sample has 2^n entries

// Bit i of f is f_i.
inline std::size_t FeatureVectors(int networks) { return std::size_t{1} << networks; }

// P(f | s) of each sample: [samples][2^n], from g: [samples][n].
template <class Real>
std::vector<Real> FeatureProbabilities(const std::vector<Real>& g, int networks);

// dE/dg: [samples][n], from dE/dP(f | s): [samples][2^n]. The product without its factor i is made of the
// other factors, never by division: g may be 0 or 1.
template <class Real>
std::vector<Real> OutputGradient(const std::vector<Real>& g, int networks,
                                 const std::vector<Real>& d_probability);

}  // namespace cairn::landmark_learning
