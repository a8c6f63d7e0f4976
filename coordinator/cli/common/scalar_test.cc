#include "coordinator/cli/common/scalar.h"

#include <gtest/gtest.h>

namespace cairn::cli {
namespace {

TEST(ToReal, TakesANumberInFullOrNotAtAll) {
  EXPECT_EQ(ToReal("0.25"), 0.25);
  EXPECT_EQ(ToReal("-1e3"), -1000.0);
  for (const char* text : {"", " 1", "1 ", "1m", "0,25", "nan", "inf", "-inf", "1e999", "0x10", "--1"}) {
    EXPECT_EQ(ToReal(text), std::nullopt) << text;
  }
}

TEST(ToInteger, TakesNoFraction) {
  EXPECT_EQ(ToInteger("-7"), -7);
  for (const char* text : {"", "7.0", "7e0", "9223372036854775808", "seven"}) {
    EXPECT_EQ(ToInteger(text), std::nullopt) << text;
  }
}

TEST(ToUnsigned, TakesAllOf64BitsAndNoSign) {
  EXPECT_EQ(ToUnsigned("18446744073709551615"), 18446744073709551615ull);
  EXPECT_EQ(ToUnsigned("-1"), std::nullopt);
  EXPECT_EQ(ToUnsigned("18446744073709551616"), std::nullopt);
}

TEST(CheckSeed, SaysWhatIsAllowed) {
  EXPECT_EQ(CheckSeed("0"), "");
  EXPECT_EQ(CheckSeed("18446744073709551615"), "");
  for (const char* text : {"-1", "18446744073709551616", "1.5", ""})
    EXPECT_NE(CheckSeed(text).find("from 0 to 18446744073709551615"), std::string::npos) << text;
}

TEST(ToBoolean, TakesTrueAndFalseOnly) {
  EXPECT_EQ(ToBoolean("true"), true);
  EXPECT_EQ(ToBoolean("false"), false);
  for (const char* text : {"True", "yes", "1", ""}) EXPECT_EQ(ToBoolean(text), std::nullopt) << text;
}

}  // namespace
}  // namespace cairn::cli
