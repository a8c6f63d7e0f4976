#include "pipelines/landmark_learning/optimizer/patterns.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pipelines/testing/in_process.h"

namespace cairn::landmark_learning {
namespace {

TEST(PatternTarget, LiesDownTheSlopeAndWithinZeroAndOne) {
  EXPECT_FLOAT_EQ(PatternTarget(0.5F, 0.1, 2.0), 0.3F);
  EXPECT_FLOAT_EQ(PatternTarget(0.5F, 0.1, -2.0), 0.7F);
  EXPECT_FLOAT_EQ(PatternTarget(0.5F, 1.0, 0.0), 0.5F);
  EXPECT_FLOAT_EQ(PatternTarget(0.5F, 1.0, 40.0), 0.001F);
  EXPECT_FLOAT_EQ(PatternTarget(0.5F, 1.0, -40.0), 0.999F);
}

double MeanSquare(const NetworkShape& shape, const std::vector<double>& weights,
                  const std::vector<float>& inputs, const std::vector<float>& target) {
  Parameters<double> parameters(shape);
  parameters.values = weights;
  const std::vector<double> wide(inputs.begin(), inputs.end());
  const auto g = Forward(parameters, wide.data(), static_cast<int>(target.size())).output;
  double sum = 0.0;
  for (std::size_t k = 0; k < g.size(); ++k) sum += 0.5 * (g[k] - target[k]) * (g[k] - target[k]);
  return sum / static_cast<double>(g.size());
}

class Fit : public ::testing::Test {
 protected:
  Fit() {
    Rng rng(5);
    weights_ = RandomParameters<double>(shape_, 0.8, rng).values;
    for (int k = 0; k < 200; ++k) {
      for (int i = 0; i < shape_.inputs; ++i) inputs_.push_back(static_cast<float>(rng.Normal()));
      target_.push_back(inputs_[inputs_.size() - 3] > 0.2F ? 0.9F : 0.1F);
    }
  }
  NetworkShape shape_{1, 3, 4};
  std::vector<double> weights_;
  std::vector<float> inputs_, target_;
  NoProgress progress_;
};

TEST_F(Fit, GoesDownTheGradientOfTheMeanSquare) {
  const double rate = 1e-2;
  const auto after =
      FitPatterns(shape_, weights_, inputs_.data(), target_, {Method::kGradient, rate}, 1, progress_);
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    auto up = weights_, down = weights_;
    up[i] += 1e-5;
    down[i] -= 1e-5;
    const double slope =
        (MeanSquare(shape_, up, inputs_, target_) - MeanSquare(shape_, down, inputs_, target_)) / 2e-5;
    EXPECT_NEAR((weights_[i] - after[i]) / rate, slope, 1e-6) << i;
  }
}

TEST_F(Fit, LearnsItsPatterns) {
  const double before = MeanSquare(shape_, weights_, inputs_, target_);
  const auto after =
      FitPatterns(shape_, weights_, inputs_.data(), target_, {Method::kMomentum, 0.5, 0.9}, 800, progress_);
  EXPECT_LT(MeanSquare(shape_, after, inputs_, target_), 0.2 * before);
}

}  // namespace
}  // namespace cairn::landmark_learning
