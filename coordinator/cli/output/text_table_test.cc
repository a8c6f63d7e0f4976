#include "coordinator/cli/output/text_table.h"

#include <gtest/gtest.h>

namespace cairn::cli {
namespace {

TEST(TextTable, ColumnsAreAsWideAsTheirWidestCell) {
  EXPECT_EQ(TextTable({{"job", "state", "note"}, {"1-museum", "done", ""}, {"2", "paused", "a  b"}}),
            "job       state   note\n1-museum  done\n2         paused  a  b\n");
}

TEST(TextTable, ACharacterIsAColumnHoweverManyBytesItHas) {
  EXPECT_EQ(TextTable({{"ü", "x"}, {"ab", "y"}}), "ü   x\nab  y\n");
}

TEST(TextTable, OfNothingIsNothing) {
  EXPECT_EQ(TextTable({}), "");
  EXPECT_EQ(TextTable({{}}), "\n");
}

}  // namespace
}  // namespace cairn::cli
