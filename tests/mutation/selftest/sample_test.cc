#include "tests/mutation/selftest/sample.h"

#include <gtest/gtest.h>

namespace cairn::mutation {
namespace {

TEST(Shared, IsWhatTwoIntervalsHaveInCommon) {
  EXPECT_EQ(Shared(0, 5, 3, 9), 2);
  EXPECT_EQ(Shared(3, 9, 0, 5), 2);
  EXPECT_EQ(Shared(0, 1, 2, 3), 0);
}

}  // namespace
}  // namespace cairn::mutation
