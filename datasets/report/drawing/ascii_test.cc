#include "datasets/report/drawing/ascii.h"

#include <gtest/gtest.h>

namespace cairn::datasets::report {
namespace {

TEST(Ascii, WritesLatinLettersByTheirBaseLetters) {
  EXPECT_EQ(Ascii("Ömer 2, Säule, é, ñ, Straße"), "Omer 2, Saule, e, n, Strasse");
  EXPECT_EQ(Ascii("Łódź, Çeşme, Țară, Đồng, Ærø, þ"), "Lodz, Cesme, Tara, Dong, AEro, th");
  EXPECT_EQ(Ascii("Sa\u0308ule"), "Saule");
  EXPECT_EQ(Ascii("−1 – 2"), "-1 - 2");
}

TEST(Ascii, AnyOtherCharacterIsOneQuestionMark) {
  EXPECT_EQ(Ascii("机器人 1"), "??? 1");
  EXPECT_EQ(Ascii("×"), "?");
  EXPECT_EQ(Ascii("\xff\xc3"), "??");
  EXPECT_EQ(Ascii(""), "");
}

}  // namespace
}  // namespace cairn::datasets::report
