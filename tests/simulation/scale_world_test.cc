#include "tests/simulation/scale_world.h"

#include <gtest/gtest.h>

namespace cairn::simulation {
namespace {

TEST(ScaleWorld, KeepsTheRightNumberOfWorkersThroughAllTrouble) {
  ScaleOutcome sum;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const ScaleOutcome outcome = ScaleWorld(seed, {}).Run(1);
    ASSERT_EQ(outcome.violation, "") << "cairn-sim --scale-days 1 --first " << seed << " --seeds 1 --trace";
    sum.started += outcome.started;
    sum.drained += outcome.drained;
    sum.lost += outcome.lost;
    sum.troubles += outcome.troubles;
    sum.most_reached += outcome.most_reached;
    sum.least_reached += outcome.least_reached;
  }
  // What was to be seen was there to see.
  EXPECT_GT(sum.started, 2000U);
  EXPECT_GT(sum.drained, 500U);
  EXPECT_GT(sum.lost, 500U);
  EXPECT_GT(sum.troubles, 500U);
  EXPECT_GT(sum.most_reached, 1000U);
  EXPECT_GT(sum.least_reached, 1000U);
}

}  // namespace
}  // namespace cairn::simulation
