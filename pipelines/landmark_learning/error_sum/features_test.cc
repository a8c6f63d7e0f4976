#include "pipelines/landmark_learning/error_sum/features.h"

#include <gtest/gtest.h>

#include <numeric>

#include "schema/rng.h"

namespace cairn::landmark_learning {
namespace {

TEST(FeatureProbabilities, AreTheProductsByHand) {
  const auto p = FeatureProbabilities<double>({0.2, 0.7}, 2);  // bit 0 is of the first network
  const std::vector<double> expected{0.8 * 0.3, 0.2 * 0.3, 0.8 * 0.7, 0.2 * 0.7};
  ASSERT_EQ(p.size(), expected.size());
  for (std::size_t f = 0; f < p.size(); ++f) EXPECT_NEAR(p[f], expected[f], 1e-15) << f;
}

TEST(FeatureProbabilities, AddUpToOneForEachSample) {
  Rng rng(1);
  std::vector<double> g(5 * 6);
  for (double& value : g) value = rng.Uniform();
  const auto p = FeatureProbabilities(g, 6);
  for (std::size_t k = 0; k < 5; ++k) EXPECT_NEAR(std::reduce(&p[64 * k], &p[64 * k] + 64), 1.0, 1e-14);
}

// E = sum_f c_f P(f) is linear in each g: its slope is the difference between g = 1 and g = 0, also where a
// network is sure.
TEST(OutputGradient, IsExactWhereNetworksAreSureToo) {
  Rng rng(2);
  std::vector<double> c(8);
  for (double& value : c) value = rng.Normal();
  const std::vector<double> outputs[] = {{0.3, 0.6, 0.9}, {0.0, 1.0, 0.5}, {1.0, 1.0, 1.0}};
  for (const std::vector<double>& g : outputs) {
    const auto gradient = OutputGradient(g, 3, c);
    for (std::size_t i = 0; i < 3; ++i) {
      double ends[2];
      for (const int end : {0, 1}) {
        std::vector<double> sure = g;
        sure[i] = end;
        const auto p = FeatureProbabilities(sure, 3);
        ends[end] = std::inner_product(p.begin(), p.end(), c.begin(), 0.0);
      }
      EXPECT_NEAR(gradient[i], ends[1] - ends[0], 1e-14) << i;
    }
  }
}

}  // namespace
}  // namespace cairn::landmark_learning
