#include "pipelines/landmark_learning/networks/input_noise.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cairn::landmark_learning {
namespace {

constexpr int kWidth = 50;

std::vector<float> Noise(int first, int end, const InputNoise& noise) {
  const std::vector<float> zero(static_cast<std::size_t>(end) * kWidth, 0.0F);
  const InputRows rows(zero.data(), {first, end}, kWidth, noise);
  return {rows.data(), rows.data() + (end - first) * kWidth};
}

TEST(InputNoise, HasTheMomentsAskedFor) {
  const InputNoise noise{.deviation = 2.0, .seed = 3, .step = 0};
  double sum = 0, squares = 0, products = 0;
  int count = 0;
  const auto now = Noise(0, 2000, noise), next = Noise(0, 2000, {2.0, 3, 1});
  for (std::size_t i = 0; i < now.size(); ++i, ++count) {
    sum += now[i];
    squares += now[i] * now[i];
    products += now[i] * next[i];
  }
  // 2,000 rows of a table of 65,536 numbers, so that some are read twice.
  EXPECT_NEAR(sum / count, 0.0, 0.05);
  EXPECT_NEAR(std::sqrt(squares / count), 2.0, 0.05);
  EXPECT_NEAR(products / count, 0.0, 0.1) << "noise of one step tells of the next";
}

TEST(InputNoise, OfASampleIsTheSameInEveryBlock) {
  const InputNoise noise{.deviation = 1.0, .seed = 3, .step = 1234567890123};
  const auto all = Noise(0, 100, noise), part = Noise(40, 60, noise);
  EXPECT_EQ(std::vector<float>(all.begin() + 40 * kWidth, all.begin() + 60 * kWidth), part);
}

TEST(InputNoise, IsAddedToTheInputs) {
  const std::vector<float> inputs{0, 0, 0, 1, 2, 3, 4, 5, 6}, zero(9, 0.0F);
  const InputNoise noise{.deviation = 0.5, .seed = 1, .step = 9};
  const InputRows noisy(inputs.data(), {1, 3}, 3, noise), alone(zero.data(), {1, 3}, 3, noise);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_FLOAT_EQ(noisy.data()[i], inputs[3 + i] + alone.data()[i]);
  EXPECT_NE(alone.data()[0], alone.data()[3]);
}

TEST(InputNoise, WhereThereIsNoneNothingIsCopied) {
  const std::vector<float> inputs{1, 2, 3, 4};
  EXPECT_EQ(InputRows(inputs.data(), {1, 2}, 2, {}).data(), inputs.data() + 2);
}

TEST(InputNoise, DependsOnSeedAndStep) {
  const auto base = Noise(0, 1, {1.0, 1, 1});
  EXPECT_NE(base, Noise(0, 1, {1.0, 2, 1}));
  EXPECT_NE(base, Noise(0, 1, {1.0, 1, 2}));
  EXPECT_NE(base, Noise(0, 1, {1.0, 1, 1 + (std::int64_t{1} << 32)}));
}

}  // namespace
}  // namespace cairn::landmark_learning
