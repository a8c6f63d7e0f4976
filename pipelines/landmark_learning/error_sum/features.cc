#include "pipelines/landmark_learning/error_sum/features.h"

#include <array>

#include "schema/error.h"

namespace cairn::landmark_learning {
namespace {

std::size_t Samples(std::size_t outputs, int networks) {
  CAIRN_DEMAND(networks >= 1 && networks <= kMostNetworks, "a number of networks that was not validated");
  return outputs / static_cast<std::size_t>(networks);
}

// Over the networks first <= i < end, doubling the table with each.
template <class Real>
void Products(const Real* g, int first, int end, Real* table) {
  table[0] = Real(1);
  std::size_t size = 1;
  for (int i = first; i < end; ++i, size *= 2) {
    for (std::size_t f = 0; f < size; ++f) {
      // [Thr98] eqs 32, 33, 41
      table[size + f] = table[f] * g[i];
      table[f] *= Real(1) - g[i];
    }
  }
}

}  // namespace

template <class Real>
std::vector<Real> FeatureProbabilities(const std::vector<Real>& g, int networks) {
  const std::size_t samples = Samples(g.size(), networks), vectors = FeatureVectors(networks);
  std::vector<Real> probabilities(samples * vectors);
  for (std::size_t k = 0; k < samples; ++k)
    Products(&g[k * static_cast<std::size_t>(networks)], 0, networks, &probabilities[k * vectors]);
  return probabilities;
}

// Factor by factor from the last network on: summing out f_i leaves the gradient of a product of the factors
// before, and the difference over f_i, weighed by that product, is the derivative by g_i.
template <class Real>
std::vector<Real> OutputGradient(const std::vector<Real>& g, int networks,
                                 const std::vector<Real>& d_probability) {
  const std::size_t samples = Samples(g.size(), networks), vectors = FeatureVectors(networks);
  std::vector<Real> gradient(g.size());
  std::vector<Real> left(vectors), before(vectors);
  for (std::size_t k = 0; k < samples; ++k) {
    const Real* own = &g[k * static_cast<std::size_t>(networks)];
    left.assign(&d_probability[k * vectors], &d_probability[k * vectors] + vectors);
    for (int i = networks - 1; i >= 0; --i) {
      const std::size_t half = FeatureVectors(i);
      Products(own, 0, i, before.data());
      Real sum = 0;
      for (std::size_t f = 0; f < half; ++f) {
        // [Thr98] eqs 40, 43: the derivative by g_i of the product 33
        sum += before[f] * (left[half + f] - left[f]);
        left[f] = (Real(1) - own[i]) * left[f] + own[i] * left[half + f];
      }
      gradient[k * static_cast<std::size_t>(networks) + static_cast<std::size_t>(i)] = sum;
    }
  }
  return gradient;
}

template std::vector<float> FeatureProbabilities(const std::vector<float>&, int);
template std::vector<double> FeatureProbabilities(const std::vector<double>&, int);
template std::vector<float> OutputGradient(const std::vector<float>&, int, const std::vector<float>&);
template std::vector<double> OutputGradient(const std::vector<double>&, int, const std::vector<double>&);

}  // namespace cairn::landmark_learning
