#include "pipelines/landmark_learning/some_networks.h"

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

}  // namespace
}  // namespace cairn::landmark_learning
