#include "pipelines/landmark_learning/networks/some_networks.h"

#include <gtest/gtest.h>

namespace cairn::landmark_learning {
namespace {

TEST(SomeNetworks, GiveTheOutputsThatTheyGiveAmongAll) {
  Rng rng(3);
  for (const int hidden_2 : {0, 3}) {
    const auto all = RandomParameters<double>({4, 3, 2, hidden_2}, 1.0, rng);
    const std::vector<double> inputs{0.3, -1.0, 2.0, 0.0, 0.5, -0.7};
    const auto whole = Forward(all, inputs.data(), 2).output;
    const auto some = Forward(SomeNetworks(all, 1, 3), inputs.data(), 2).output;
    for (std::size_t row = 0; row < 2; ++row) {
      for (std::size_t n = 0; n < 2; ++n) EXPECT_EQ(some[row * 2 + n], whole[row * 4 + n + 1]);
    }
  }
}

TEST(SomeNetworks, ComeBackToTheirPlacesAndLeaveTheOthers) {
  Rng rng(4);
  const auto all = RandomParameters<float>({3, 2, 2, 4}, 1.0, rng);
  Parameters<float> built(all.shape);
  PutNetworks(SomeNetworks(all, 0, 1), 0, &built);
  EXPECT_NE(built.values, all.values);
  PutNetworks(SomeNetworks(all, 1, 3), 1, &built);
  EXPECT_EQ(built.values, all.values);
}

TEST(SomeNetworks, AloneHaveTheGradientThatTheyHaveAmongAll) {
  Rng rng(6);
  for (const int hidden_2 : {0, 3}) {
    const auto all = RandomParameters<float>({4, 3, 5, hidden_2}, 1.0, rng);
    std::vector<float> inputs, d_output;
    for (int i = 0; i < 100 * 3; ++i) inputs.push_back(static_cast<float>(rng.Normal()));
    for (int i = 0; i < 100 * 4; ++i) d_output.push_back(static_cast<float>(rng.Normal()));
    const auto activations = Forward(all, inputs.data(), 100);
    const auto whole = Backward(all, inputs.data(), 100, activations, d_output);
    for (const int first : {0, 1, 3}) {
      const auto own = BackwardFrom(first, all, inputs.data(), 100, activations, d_output);
      EXPECT_EQ(own.shape.networks, 4 - first);
      EXPECT_EQ(own.values, SomeNetworks(whole, first, 4).values) << first;
    }
  }
}

}  // namespace
}  // namespace cairn::landmark_learning
