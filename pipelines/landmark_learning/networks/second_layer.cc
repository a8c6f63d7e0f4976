#include "pipelines/landmark_learning/networks/second_layer.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "pipelines/landmark_learning/error_sum/lane_math.h"

namespace cairn::landmark_learning {

// Inner loops go over units, never over the terms of one sum: they may be vectorised without other bits.
template <class Real>
std::vector<Real> SecondLayer(const Parameters<Real>& parameters, const std::vector<Real>& hidden, int rows) {
  const NetworkShape& s = parameters.shape;
  std::vector<Real> second(static_cast<std::size_t>(rows) * static_cast<std::size_t>(s.last_units()));
  const Real* in = hidden.data();
  Real* out = second.data();
  for (int row = 0; row < rows; ++row) {
    const Real* weights = parameters.SecondWeights();
    const Real* biases = parameters.SecondBiases();
    for (int n = 0; n < s.networks; ++n, in += s.hidden, out += s.hidden_2, biases += s.hidden_2) {
      std::copy_n(biases, s.hidden_2, out);
      for (int h = 0; h < s.hidden; ++h, weights += s.hidden_2) {
        // [Thr98] section 5.1.4: two hidden layers
        for (int u = 0; u < s.hidden_2; ++u) out[u] = std::fma(in[h], weights[u], out[u]);
      }
    }
  }
  SigmoidOfAll(static_cast<int>(second.size()), second.data());
  return second;
}

template <class Real>
void BackThroughSecond(const Parameters<Real>& parameters, const Real* hidden, const Real* d_second,
                       Parameters<Real>* gradient, Real* d_hidden) {
  const NetworkShape& s = parameters.shape;
  const Real* weights = parameters.SecondWeights();
  Real* by_weights = gradient->SecondWeights();
  Real* biases = gradient->SecondBiases();
  for (int n = 0; n < s.networks; ++n, d_second += s.hidden_2, biases += s.hidden_2) {
    for (int u = 0; u < s.hidden_2; ++u) biases[u] += d_second[u];
    for (int h = 0; h < s.hidden;
         ++h, ++hidden, ++d_hidden, weights += s.hidden_2, by_weights += s.hidden_2) {
      Real sum = Real(0);
      for (int u = 0; u < s.hidden_2; ++u) sum = std::fma(weights[u], d_second[u], sum);
      for (int u = 0; u < s.hidden_2; ++u) by_weights[u] = std::fma(*hidden, d_second[u], by_weights[u]);
      *d_hidden = sum * *hidden * (Real(1) - *hidden);
    }
  }
}

template std::vector<float> SecondLayer(const Parameters<float>&, const std::vector<float>&, int);
template std::vector<double> SecondLayer(const Parameters<double>&, const std::vector<double>&, int);
template void BackThroughSecond(const Parameters<float>&, const float*, const float*, Parameters<float>*,
                                float*);
template void BackThroughSecond(const Parameters<double>&, const double*, const double*, Parameters<double>*,
                                double*);

}  // namespace cairn::landmark_learning
