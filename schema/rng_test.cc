#include "schema/rng.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cairn {
namespace {

// Known answers of Random123's kat_vectors, philox4x32 10.
TEST(Philox, GivesTheReferenceAnswers) {
  EXPECT_EQ(Philox4x32({0, 0, 0, 0}, {0, 0}),
            (std::array<std::uint32_t, 4>{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(Philox4x32({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}),
            (std::array<std::uint32_t, 4>{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
}

TEST(Rng, StreamsDifferAndRepeat) {
  Rng a(7, 1, 2), again(7, 1, 2), other_task(7, 1, 3), other_round(7, 2, 2), other_seed(8, 1, 2);
  const std::uint64_t first = a.Bits64();
  EXPECT_EQ(first, again.Bits64());
  EXPECT_NE(first, other_task.Bits64());
  EXPECT_NE(first, other_round.Bits64());
  EXPECT_NE(first, other_seed.Bits64());
}

TEST(Rng, DistributionsHaveTheirMoments) {
  Rng rng(1);
  constexpr int kDraws = 200000;
  double sum = 0, squares = 0, uniform = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double z = rng.Normal();
    sum += z;
    squares += z * z;
    const double u = rng.Uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    uniform += u;
  }
  EXPECT_NEAR(sum / kDraws, 0.0, 0.01);
  EXPECT_NEAR(squares / kDraws, 1.0, 0.02);
  EXPECT_NEAR(uniform / kDraws, 0.5, 0.005);
}

TEST(Rng, BelowCoversItsRangeEvenly) {
  Rng rng(3);
  std::array<int, 7> counts{};
  for (int i = 0; i < 70000; ++i) ++counts.at(rng.Below(7));
  for (const int count : counts) EXPECT_NEAR(count, 10000, 500);
}

}  // namespace
}  // namespace cairn
