#include "pipelines/pipeline.h"

#include <gtest/gtest.h>

#include "schema/step_limits.h"

namespace cairn {
namespace {

// A guess decides nothing, and a coordinator takes no step that expects more.
TEST(ExpectRounds, OfMoreThanAnyTimeItIsTheMost) {
  proto::Step plan;
  ExpectRounds(2, 10, 3, &plan);
  ExpectRounds(1, 1e30, 0, &plan);
  ASSERT_EQ(plan.later_size(), 2);
  EXPECT_EQ(plan.later(0).cost(), 10);
  EXPECT_EQ(plan.later(1).cost(), kMostAmount);
}

}  // namespace
}  // namespace cairn
