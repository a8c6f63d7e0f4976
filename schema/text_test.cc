#include "schema/text.h"

#include <gtest/gtest.h>

#include "schema/blob.h"

namespace cairn {
namespace {

TEST(Text, IsCutBetweenCharacters) {
  EXPECT_EQ(CutTo("abc", 3), "abc");
  EXPECT_EQ(CutTo("abc", 2), "ab");
  EXPECT_EQ(CutTo("aü", 2), "a");
  EXPECT_EQ(CutTo("aü", 3), "aü");
}

TEST(Text, NothingThatATerminalObeysIsShown) {
  EXPECT_EQ(Escaped("Rosa\x1b[2J\x07\r"), "Rosa\\u001b[2J\\u0007\\u000d");
  EXPECT_EQ(EscapedName("x\ncairn: all is fine\t\x1b"), "x\\ncairn: all is fine\\t\\u001b");
  EXPECT_EQ(Escaped(std::string("a\0b", 3)), "a\\u0000b");
  EXPECT_EQ(Escaped("a\x7f\xc2\x9b"), "a\\u007f\\u009b")
      << "DEL, and the C1 character that begins a sequence";
  EXPECT_EQ(Escaped("\x9b\xff\xc3"), "\\x9b\\xff\\xc3") << "no UTF-8";
  EXPECT_EQ(Escaped("\xe2\x80\xae"
                    "txt"),
            "\\u202etxt")
      << "which would be shown backwards";
  EXPECT_EQ(Escaped("two\nlines\tGrüße 日本 🤖"), "two\nlines\tGrüße 日本 🤖");
}

TEST(InputError, SaysAllOfWhatItQuotes) {
  const InputError error(std::string("od.csv:3: turn_rad is '0\0x', which is no number", 47));
  EXPECT_STREQ(error.what(), "od.csv:3: turn_rad is '0\\u0000x', which is no number");
}

// Every byte after every other: what is left is UTF-8 without a control character.
TEST(Text, WhateverTheBytesWhatIsShownIsPlain) {
  for (int first = 0; first < 256; ++first) {
    for (int second = 0; second < 256; ++second) {
      const std::string shown =
          Escaped(std::string{static_cast<char>(first), static_cast<char>(second), 'x'});
      EXPECT_EQ(WhatIsWrongWithText(shown), "") << first << " " << second;
    }
  }
}

TEST(Text, ANameIsShortUtf8WithoutControlCharacters) {
  EXPECT_EQ(WhatIsWrongWithName("Grüße 日本"), "");
  EXPECT_EQ(WhatIsWrongWithName(""), "");
  EXPECT_EQ(WhatIsWrongWithName(std::string(256, 'a')), "");
  EXPECT_EQ(WhatIsWrongWithName(std::string(257, 'a')), "is longer than 256 bytes");
  for (const char* other : {"Gr\xfc\xdf", "\xc0\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80", "a\xe2\x82"})
    EXPECT_EQ(WhatIsWrongWithName(other), "is not UTF-8") << other;
  for (const std::string other : {"a\nb", "a\tb", "\x1b[31m", "\x7f", "\xc2\x85", "\xe2\x81\xa6"})
    EXPECT_EQ(WhatIsWrongWithName(other), "has control characters") << other;
  EXPECT_EQ(WhatIsWrongWithName(std::string("a\0", 2)), "has control characters");
  EXPECT_EQ(WhatIsWrongWithText("two\r\nlines\tof text"), "");
}

TEST(CheckTexts, LooksAtEveryNameAndEveryText) {
  const auto check = [](const std::string& name, const Array& array) {
    Blob blob;
    blob.Put(name, array);
    return CheckTexts(blob).message();
  };
  EXPECT_EQ(check("robots", Array::Texts({"Rosa", "Grüß", ""})), "");
  EXPECT_EQ(check("provenance/job_yaml", Array::Text("name: a\nseed: 7\n")), "");
  EXPECT_EQ(check("robots", Array::Texts({"Rosa", "R\xf6"})), "dataset 'robots': 'R\\xf6' is not UTF-8");
  EXPECT_EQ(check("warnings", Array::Texts({"a\x1b[2J"})),
            "dataset 'warnings': 'a\\u001b[2J' has control characters");
  EXPECT_EQ(check("provenance/job_yaml", Array::Text("a\x1b")),
            "dataset 'provenance/job_yaml': 'a\\u001b' has control characters");
  EXPECT_EQ(check("a\x1b[2J", Array::Vector<double>({1})),
            "the name of the dataset 'a\\u001b[2J' has control characters");
  EXPECT_NE(check("robots", Array::Texts({std::string(257, 'a')})), "");
  EXPECT_EQ(
      check("robots", Array::FromBytes(DType::kText, 3, {1}, std::as_bytes(std::span("a\0b", 3))).value()),
      "dataset 'robots': 'a\\u0000b' has control characters");
}

TEST(CheckForms, AreThoseThatAFileHoldsAndGivesBack) {
  const auto check = [](const std::vector<std::string>& names, const Shape& shape = {1}) {
    Blob blob;
    for (const std::string& name : names)
      blob.Put(name, Array::FromBytes(DType::kU8, 1, shape, std::as_bytes(std::span("a", 1))).value());
    return CheckForms(blob).message();
  };
  EXPECT_EQ(check({"a", "b/a", "b/a-1", "b/ab/c"}), "");
  for (const std::string name : {"", "/", "/a", "a/", "a//b", ".", "a/./b"})
    EXPECT_EQ(check({name}), "the name of the dataset '" + name + "' has a part that is empty or '.'");
  EXPECT_EQ(check({"a", "a-", "a/b"}), "the name of the dataset 'a/b' lies in 'a', which is a dataset");
  std::string deep = "a";
  for (int i = 0; i < 31; ++i) deep += "/a";
  EXPECT_EQ(check({deep}), "");
  EXPECT_NE(check({deep + "/a"}).find("more than 32 deep"), std::string::npos);
  EXPECT_EQ(check({"a"}, Shape(32, 1)), "");
  EXPECT_EQ(check({"a"}, Shape(33, 1)), "dataset 'a': of more than 32 dimensions");
}

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

TEST(ShellWord, IsQuotedWhereAShellWouldTakeItApart) {
  EXPECT_EQ(ShellWord("a/b-c.h5"), "a/b-c.h5");
  EXPECT_EQ(ShellWord("it's mine"), "'it'\\''s mine'");
  EXPECT_EQ(ShellWord("$(rm)"), "'$(rm)'");
  EXPECT_EQ(ShellWord(""), "''");
}

TEST(NameList, ShowsAHandfulAndCountsTheOthers) {
  EXPECT_EQ(NameList({}), "none");
  EXPECT_EQ(NameList({"ann"}), "'ann'");
  EXPECT_EQ(NameList({"a", "b", "c", "d", "e"}), "'a', 'b', 'c', 'd', 'e'");
  EXPECT_EQ(NameList({"a", "b", "c"}, 2), "'a', 'b' and 1 more");
  EXPECT_EQ(NameList(std::vector<std::string>(200'000, "r")), "'r', 'r', 'r', 'r', 'r' and 199995 more");
}

}  // namespace
}  // namespace cairn
