#include "pipelines/localization/sensing.h"

#include <cmath>

#include "schema/error.h"

namespace cairn::localization {

std::vector<double> MeanFeatures(const std::vector<std::size_t>& samples, const std::vector<double>& output,
                                 std::size_t features, double prior_count) {
  std::vector<double> sum(features, prior_count);
  for (const std::size_t sample : samples) {
    for (std::size_t i = 0; i < features; ++i) sum[i] += output[sample * features + i];
  }
  // [Thr98] section 5.1.6
  for (double& s : sum) s /= static_cast<double>(samples.size()) + 2.0 * prior_count;
  return sum;
}

std::vector<double> Drawn(const std::vector<double>& output, Rng& rng) {
  std::vector<double> feature;
  // [Thr98] eq. 32
  for (const double g : output) feature.push_back(rng.Uniform() < g ? 1.0 : 0.0);
  return feature;
}

std::vector<double> Likelihood(const std::vector<double>& map, const std::vector<double>& feature,
                               const FeatureGroup& group, double trust) {
  CAIRN_DEMAND(!feature.empty() && map.size() % feature.size() == 0, "a row of the map for each position");
  std::vector<double> likelihood;
  for (std::size_t row = 0; row < map.size(); row += feature.size()) {
    double product = 1.0;
    for (std::size_t i = group.first; i < group.end; ++i) {
      const double one = map[row + i];
      // [Thr98] eqs 32, 33: where the feature is not drawn, the expectation over f of P(f | xi)
      product *= feature[i] * one + (1.0 - feature[i]) * (1.0 - one);
    }
    likelihood.push_back(trust == 1.0 ? product : std::pow(product, trust));
  }
  return likelihood;
}

}  // namespace cairn::localization
