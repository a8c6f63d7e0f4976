#include "pipelines/landmark_learning/optimizer/batch.h"

#include <gtest/gtest.h>

namespace cairn::landmark_learning {
namespace {

TEST(DrawnStretches, AreAllTruePositionsWhereTheBatchIsAsLarge) {
  for (const std::int64_t batch : {0, 500, 900}) {
    const auto all = DrawnStretches(500, batch, 1, 3);
    ASSERT_EQ(all.size(), 1U);
    EXPECT_EQ(all[0].first, 0);
    EXPECT_EQ(all[0].end, 500);
  }
}

TEST(DrawnStretches, TakeEveryTruthEquallyOftenAndNoneTwiceInAStep) {
  constexpr int kCount = 1000, kSteps = 4000;
  std::vector<int> taken(kCount, 0);
  for (int step = 0; step < kSteps; ++step) {
    int last = 0;
    const auto stretches = DrawnStretches(kCount, 200, 7, step);
    EXPECT_EQ(stretches.size(), 4U);
    for (const IndexRange& range : stretches) {
      EXPECT_GE(range.first, last);
      last = range.end;
      for (int a = range.first; a < range.end; ++a) ++taken[static_cast<std::size_t>(a)];
    }
    EXPECT_LE(last, kCount);
  }
  const int expected = kSteps * 4 / 16;
  for (const int times : taken) EXPECT_NEAR(times, expected, 120);  // four standard deviations
}

TEST(DrawnStretches, DependOnSeedAndStepAlone) {
  const auto drawn = [](std::uint64_t seed, std::int64_t step) {
    std::vector<int> firsts;
    for (const IndexRange& range : DrawnStretches(5000, 300, seed, step)) firsts.push_back(range.first);
    return firsts;
  };
  EXPECT_EQ(drawn(1, 5), drawn(1, 5));
  EXPECT_NE(drawn(1, 5), drawn(1, 6));
  EXPECT_NE(drawn(1, 5), drawn(2, 5));
}

}  // namespace
}  // namespace cairn::landmark_learning
