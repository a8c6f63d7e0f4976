#include "datasets/evaluate/reduction_interval.h"

#include <gtest/gtest.h>

namespace cairn::datasets {
namespace {

TEST(StudentT975, IsTheTables) {
  EXPECT_NEAR(StudentT975(1), 12.7062, 1e-3);
  EXPECT_NEAR(StudentT975(9), 2.26216, 1e-4);
  EXPECT_NEAR(StudentT975(10), 2.22814, 4e-4);
  EXPECT_NEAR(StudentT975(30), 2.04227, 1e-4);
  EXPECT_NEAR(StudentT975(100000), 1.95999, 1e-4);
}

TEST(ReductionOf, IsOneMinusTheRatioOfTheSums) {
  EXPECT_DOUBLE_EQ(*ReductionOf({{1, 1}, {3, 1}}), 0.5);
  EXPECT_FALSE(ReductionOf({{0, 0}}));
}

TEST(ReductionInterval, NeedsTwoClusters) {
  EXPECT_FALSE(ReductionInterval({{1, 0.5}}, Rng(1)));
  EXPECT_TRUE(ReductionInterval({{1, 0.5}, {1, 0.5}}, Rng(1)));
}

TEST(ReductionInterval, HasNoWidthWhereClustersAgree) {
  const auto interval = ReductionInterval({{2, 1}, {4, 2}, {6, 3}}, Rng(1));
  ASSERT_TRUE(interval);
  EXPECT_NEAR(interval->low, 0.5, 1e-12);
  EXPECT_NEAR(interval->high, 0.5, 1e-12);
}

// Two clusters: a resample is either of them twice, or both: the reduction 0.4, 0.5, 0.6 in a quarter, a half
// and a quarter of the cases. Standard deviation sqrt(0.005), times sqrt(2), times t: 1.2706.
TEST(ReductionInterval, OfTwoClustersByHand) {
  const auto interval = ReductionInterval({{1, 0.6}, {1, 0.4}}, Rng(1));
  ASSERT_TRUE(interval);
  EXPECT_NEAR(interval->low, 0.5 - 1.2706, 0.05);
  EXPECT_EQ(interval->high, 1.0);
}

TEST(ReductionInterval, IsTheSameEveryTime) {
  const std::vector<ErrorSums> clusters = {{1, 0.6}, {2, 0.9}, {1.5, 0.7}};
  const auto first = ReductionInterval(clusters, Rng(4)), second = ReductionInterval(clusters, Rng(4));
  EXPECT_EQ(first->low, second->low);
  EXPECT_EQ(first->high, second->high);
}

// Runs whose prior and posterior errors are drawn around 1 and 0.6, together and each for itself: the true
// reduction is 0.4, and 95% intervals hold it in about 95 of 100 experiments, however few the runs.
TEST(ReductionInterval, CoversTheTruthInAbout95Of100Experiments) {
  constexpr int kExperiments = 600;
  for (const int runs : {2, 3, 5, 12}) {
    int covered = 0;
    for (int experiment = 0; experiment < kExperiments; ++experiment) {
      Rng rng(11, static_cast<std::uint64_t>(experiment), static_cast<std::uint32_t>(runs));
      std::vector<ErrorSums> clusters;
      for (int r = 0; r < runs; ++r) {
        const double common = 0.1 * rng.Normal();
        clusters.push_back({1 + common, 0.6 + 0.6 * common + 0.1 * rng.Normal()});
      }
      const auto interval = ReductionInterval(clusters, Rng(12, static_cast<std::uint64_t>(experiment)));
      ASSERT_TRUE(interval);
      covered += interval->low <= 0.4 && 0.4 <= interval->high ? 1 : 0;
    }
    // Three standard deviations of a binomial: 2.7%.
    EXPECT_GT(covered, 0.92 * kExperiments) << runs << " runs";
    EXPECT_LT(covered, 0.98 * kExperiments) << runs << " runs";
  }
}

}  // namespace
}  // namespace cairn::datasets
