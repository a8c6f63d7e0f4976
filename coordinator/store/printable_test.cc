#include "coordinator/store/printable.h"

#include <gtest/gtest.h>

namespace cairn::coordinator {
namespace {

TEST(Printable, LeavesWordsOfAnyLanguageAsTheyAre) {
  EXPECT_EQ(Printable("größe 日本 🜨", 100), "größe 日本 🜨");
  EXPECT_EQ(Printable("", 100), "");
}

TEST(Printable, ControlCharactersBecomeBlanks) {
  EXPECT_EQ(Printable("a\nb\x1b[31mc\x7f", 100), "a b [31mc ");
}

TEST(Printable, CutsBetweenCharacters) {
  EXPECT_EQ(Printable("aü", 3), "aü");
  EXPECT_EQ(Printable("aüb", 2), "a…");
  EXPECT_EQ(Printable("abc", 2), "ab…");
}

TEST(Printable, WhatIsNoUtf8BecomesQuestionMarks) {
  EXPECT_EQ(Printable("a\xff\xc3", 100), "a??") << "no character, and one that is cut off";
  EXPECT_EQ(Printable("\xc0\xaf", 100), "??") << "longer than needed";
  EXPECT_EQ(Printable("\xed\xa0\x80", 100), "???") << "a surrogate";
  EXPECT_EQ(Printable("\xf4\x90\x80\x80", 100), "????") << "beyond the last character";
}

}  // namespace
}  // namespace cairn::coordinator
