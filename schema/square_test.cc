#include "schema/square.h"

#include <gtest/gtest.h>

namespace cairn {
namespace {

TEST(Square, IsOfBothSignsTheSame) {
  EXPECT_EQ(Square(-1.5), 2.25);
  EXPECT_EQ(Square(1.5), 2.25);
  EXPECT_EQ(Square(0.0), 0.0);
}

}  // namespace
}  // namespace cairn
