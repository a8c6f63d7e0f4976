#include "schema/name_list.h"

#include <gtest/gtest.h>

namespace cairn {
namespace {

TEST(NameList, ShowsAHandfulAndCountsTheOthers) {
  EXPECT_EQ(NameList({}), "none");
  EXPECT_EQ(NameList({"ann"}), "'ann'");
  EXPECT_EQ(NameList({"a", "b", "c", "d", "e"}), "'a', 'b', 'c', 'd', 'e'");
  EXPECT_EQ(NameList({"a", "b", "c"}, 2), "'a', 'b' and 1 more");
  EXPECT_EQ(NameList(std::vector<std::string>(200'000, "r")), "'r', 'r', 'r', 'r', 'r' and 199995 more");
}

}  // namespace
}  // namespace cairn
