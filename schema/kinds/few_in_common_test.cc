#include "schema/kinds/few_in_common.h"

#include <gtest/gtest.h>

namespace cairn {
namespace {

TEST(FewestInCommon, AreWhereWhatWasSeenBeforeIsSeenLeastAgain) {
  // 0 and 1, a false one, 2, then 2 to 4: after the sixth observation one of three is on both sides.
  const std::vector<std::int32_t> seen = {0, 1, -1, 0, 1, 2, 3, 2, 4, 3, 4};
  const FewInCommon least = FindFewestInCommon({seen});
  EXPECT_EQ(least.common, 1U);
  EXPECT_EQ(least.of, 3U);
  EXPECT_EQ(least.number, 6U);
  EXPECT_TRUE(least.AreFew());
  const std::vector<std::int32_t> again = {0, 1, 2, 3, 4, 0, 1, 2, 3, 4};
  EXPECT_FALSE(FindFewestInCommon({again}).AreFew());
  EXPECT_EQ(FindFewestInCommon({{}}).of, 0U);
}

TEST(FewestInCommon, CountWhatAnotherRobotSawOfBothSides) {
  const std::vector<std::int32_t> seen = {0, 1, 0, 1, 2, 3, 2, 4, 3, 4}, other = {0, 1, 2, 3, 4};
  EXPECT_TRUE(FindFewestInCommon({seen}).AreFew());
  EXPECT_FALSE(FindFewestInCommon({seen, other}).AreFew());
}

}  // namespace
}  // namespace cairn
