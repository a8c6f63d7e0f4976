#include "datasets/csv_reader.h"

#include "datasets/testing.h"

namespace cairn::datasets {
namespace {

TEST(ParseNumber, TakesFiniteNumbersOnly) {
  const char* reason = "";
  EXPECT_EQ(ParseNumber(" 1.5 ", &reason), 1.5);
  EXPECT_EQ(ParseNumber("+2", &reason), 2.0);
  EXPECT_EQ(ParseNumber("-1e-3", &reason), -0.001);
  EXPECT_EQ(ParseNumber("1e-999", &reason), 0.0);
  for (const char* text : {"", "1,5", "1.5m", "one", "0x10", "+-1", "--1", "1 2"}) {
    EXPECT_FALSE(ParseNumber(text, &reason)) << text;
    EXPECT_STREQ(reason, "not a number") << text;
  }
  for (const char* text : {"nan", "NaN", "inf", "-inf", "1e999"}) {
    EXPECT_FALSE(ParseNumber(text, &reason)) << text;
    EXPECT_STREQ(reason, "not finite") << text;
  }
}

TEST(CsvReader, FindsColumnsByNameInPlainAndGzippedFiles) {
  const TestFolder folder;
  for (const char* name : {"a.csv", "a.csv.gz"}) {
    const std::string path = folder.Put(name,
                                        "\xEF\xBB\xBF"
                                        "extra, b ,a\r\n1,2, 3\r\n\r\n4,5,6");
    BadLines bad(false);
    CsvReader reader(path, {{"a", "c"}, {"a", "b"}}, &bad);
    EXPECT_EQ(reader.header(), 1U);
    EXPECT_EQ(reader.extra_columns(), std::vector<std::string>{"extra"});
    ASSERT_TRUE(reader.Next());
    EXPECT_EQ(reader.line(), 2U);
    EXPECT_EQ(reader.Number(0), 3.0);
    EXPECT_EQ(reader.Number(1), 2.0);
    ASSERT_TRUE(reader.Next());
    EXPECT_EQ(reader.line(), 4U);
    EXPECT_EQ(reader.Text(0), "6");
    EXPECT_FALSE(reader.Next());
  }
}

TEST(CsvReader, TakesQuotedFields) {
  const TestFolder folder;
  const std::string path = folder.Put("a.csv", "a,\"b\"\n\"x, \"\"y\"\"\",2\n");
  BadLines bad(false);
  CsvReader reader(path, {{"a", "b"}}, &bad);
  ASSERT_TRUE(reader.Next());
  EXPECT_EQ(reader.Text(0), "x, \"y\"");
  EXPECT_EQ(reader.Number(1), 2.0);
}

TEST(CsvReader, NamesFileLineAndReason) {
  const TestFolder folder;
  const auto message = [&](const std::string& text) {
    const std::string path = folder.Put("a.csv", text);
    return InputErrorOf([&] {
      BadLines bad(false);
      CsvReader reader(path, {{"a", "b"}, {"a", "c"}}, &bad);
      while (reader.Next()) reader.Number(0);
    });
  };
  ExpectContains(message(""), "a.csv: is empty; a header is needed: a,b");
  ExpectContains(message("a,d\n"), "a.csv:1: the header lacks columns: it must have a,b or a,c, it has a,d");
  ExpectContains(message("a,b,a\n"), "a.csv:1: the header has a twice");
  ExpectContains(message("a,b\n1,2\n1,2,3\n"), "a.csv:3: wrong number of columns: 3 where the header has 2");
  ExpectContains(message("a,b\n1,\"2\n"), "a.csv:2: open quote");
  ExpectContains(message("a,b\nx,2\n"), "a.csv:2: not a number: a is 'x'");
  EXPECT_EQ(message("a,b\n1,x\n"), "");
}

TEST(CsvReader, CountsBadLinesWhereTheyAreSkipped) {
  const TestFolder folder;
  const std::string path = folder.Put("a.csv", "a\n1\nx\n2,3\nnan\ny\n");
  BadLines bad(true);
  CsvReader reader(path, {{"a"}}, &bad);
  int good = 0;
  while (reader.Next()) good += reader.Number(0).has_value();
  EXPECT_EQ(good, 1);
  EXPECT_EQ(bad.counts(), (std::map<std::string, std::int64_t>{
                              {"not a number", 2}, {"not finite", 1}, {"wrong number of columns", 1}}));
}

TEST(ReadText, RefusesWhatIsNotThereOrDamaged) {
  const TestFolder folder;
  ExpectContains(InputErrorOf([&] { ReadText(folder / "none.csv"); }), "none.csv: cannot open: No such file");
  ExpectContains(InputErrorOf([&] { ReadText(folder / ""); }), "is a folder");
  std::string text;
  for (int i = 0; i < 1000; ++i) text += std::to_string(i * 7919) + "\n";
  const std::string good = FileText(folder.Put("a.gz", text));
  EXPECT_EQ(ReadText(folder / "a.gz"), text);
  for (const std::size_t size : {good.size() / 2, good.size() - 1, good.size() - 6}) {
    const std::string cut = folder.Put("cut", good.substr(0, size));
    ExpectContains(InputErrorOf([&] { ReadText(cut); }), "cut: the gzip stream is damaged or cut short");
  }
  std::string flipped = good;
  flipped[good.size() / 2] ^= 1;
  const std::string bad = folder.Put("bad", flipped);
  ExpectContains(InputErrorOf([&] { ReadText(bad); }), "bad: the gzip stream is damaged or cut short");
}

}  // namespace
}  // namespace cairn::datasets
