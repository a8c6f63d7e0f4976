#include "datasets/import/csv_reader.h"

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

TEST(CsvReader, PassesOverWhatSpreadsheetsSayOfTheSeparator) {
  const TestFolder folder;
  BadLines bad(false);
  CsvReader reader(folder.Put("a.csv", "\xEF\xBB\xBFsep=;\r\na;b\r\n1,5;2\r\n"), {{"a", "b"}}, &bad);
  ASSERT_TRUE(reader.Next());
  EXPECT_EQ(reader.line(), 3U);
  EXPECT_EQ(reader.Number(0), 1.5);
  const std::string other = folder.Put("b.csv", "sep=;\na;c\n");
  try {
    CsvReader refused(other, {{"a", "b"}}, &bad);
    FAIL();
  } catch (const InputError& error) {
    ExpectContains(error.what(), "b.csv:2: the header lacks columns");
  }
  EXPECT_THROW(CsvReader(folder.Put("c.csv", "sep=;\n"), {{"a", "b"}}, &bad), InputError);
}

TEST(CsvReader, NamesTheLineOfANumberThatNoRobotComesTo) {
  const TestFolder folder;
  BadLines bad(true);
  CsvReader reader(folder.Put("a.csv", "time_s,x_m\n1e308,1\n1.7e18,2\n1.7e9,-1e308\n"), {{"time_s", "x_m"}},
                   &bad);
  ASSERT_TRUE(reader.Next());
  EXPECT_FALSE(reader.Number(0));
  ASSERT_TRUE(reader.Next());
  EXPECT_EQ(reader.Number(0), 1.7e18) << "nanoseconds, of which others ask";
  ASSERT_TRUE(reader.Next());
  EXPECT_EQ(reader.Number(0), 1.7e9);
  EXPECT_FALSE(reader.Number(1));
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

// All rows' numbers of columns time_s, range_m, bearing_rad; or what is wrong.
std::string Rows(const std::string& text) {
  const TestFolder folder;
  const std::string path = folder.Put("a.csv", text);
  std::string rows;
  const std::string wrong = InputErrorOf([&] {
    BadLines bad(false);
    CsvReader reader(path, {{"time_s", "robot?", "range_m", "bearing_rad"}}, &bad);
    while (reader.Next()) {
      char row[96];
      std::snprintf(row, sizeof row, "%g %s %g %.6g\n", reader.Number(0).value(),
                    reader.Has(1) ? std::string(reader.Text(1)).c_str() : "-", reader.Number(2).value(),
                    reader.Number(3).value());
      rows += row;
    }
  });
  return wrong.empty() ? rows : wrong;
}

TEST(CsvReader, TakesOtherSeparatorsAndDecimalCommas) {
  const std::string read = "1 - 2.5 0.25\n2 - 3 -1\n";
  EXPECT_EQ(Rows("time_s,range_m,bearing_rad\n1,2.5,0.25\n2,3,-1\n"), read);
  EXPECT_EQ(Rows("time_s;range_m;bearing_rad\n1;2.5;0.25\n2;3;-1\n"), read);
  EXPECT_EQ(Rows("time_s;range_m;bearing_rad\r\n1;2,5;0,25\r\n2; 3;-1\r\n"), read);
  EXPECT_EQ(Rows("\xEF\xBB\xBF\"time_s\"; \"range_m\";\"bearing_rad\"\n\"1\";\"2,5\";\"0,25\"\n2;3;-1\n"),
            read);
  EXPECT_EQ(Rows("time_s\trange_m\tbearing_rad\n1\t2.5\t0.25\n2\t3\t-1\n"), read);
  ExpectContains(Rows("time_s;range_m;bearing_rad\n1;2,5;0.25\n"),
                 "a.csv:2: decimal commas and points in one file");
  ExpectContains(Rows("time_s;range_m;bearing_rad\n1;1.000,5;0\n"), "not a number: range_m is '1.000,5'");
  ExpectContains(Rows("time_s,range_m,bearing_rad\n1,2,5,0,25\n"), "wrong number of columns");
  ExpectContains(Rows(std::string("\xFF\xFEt\0", 4)), "is UTF-16; save it as UTF-8");
}

TEST(CsvReader, TakesTheUnitsThatTheHeaderSays) {
  EXPECT_EQ(Rows("time_ms,range_mm,bearing_deg\n1500,2500,90\n"), "1.5 - 2.5 1.5708\n");
  EXPECT_EQ(Rows("time_us,range_cm,bearing_rad\n1500000,250,1\n"), "1.5 - 2.5 1\n");
  EXPECT_EQ(Rows("time_ms,time_s,range_m,bearing_rad\n9,1,2,1\n"), "1 - 2 1\n") << "the right one counts";
  for (const char* both :
       {"time_s,time_ns,range_m,bearing_rad\n9,1,2,1\n", "Time_NS,time_s,range_m,bearing_rad\n1,2,3,4\n"})
    ExpectContains(Rows(both),
                   "a.csv:1: the header has both time_s and time_ns, and does not say whether time_ns is "
                   "the whole time or what goes beyond whole seconds");
  ExpectContains(Rows("time_s,range_ft,bearing_rad\n"),
                 "the header lacks columns: it must have "
                 "time_s[,robot],range_m,bearing_rad");
}

TEST(CsvReader, PassesOverComments) {
  const std::string read = "1 - 2.5 0.25\n2 - 3 -1\n";
  EXPECT_EQ(
      Rows(
          "# My robot, on Monday\n#\n\ntime_s,range_m,bearing_rad\n1,2.5,0.25\n # it \"stood\n2,3,-1\n# end"),
      read);
  EXPECT_EQ(Rows("# of three,fields,too\ntime_s,range_m,bearing_rad\n#1,9,9\n1,2.5,0.25\n2,3,-1\n"), read);
  EXPECT_EQ(Rows("sep=;\n# a\ntime_s;range_m;bearing_rad\n1;2.5;0.25\n2;3;-1\n"), read);
  ExpectContains(Rows("# a\n# b\n"), "a.csv: is empty; a header is needed");
  ExpectContains(Rows("# a\ntime_s,range_m\n"), "a.csv:2: the header lacks columns");
  ExpectContains(Rows("# a\ntime_s,range_m,bearing_rad\n# b\nx,1,1\n"), "a.csv:4: not a number");
}

// As numpy writes it.
TEST(CsvReader, AHeaderMayStandBehindTheMarkOfAComment) {
  const std::string read = "1 - 2.5 0.25\n2 - 3 -1\n";
  EXPECT_EQ(Rows("# me\n# time_s,range_m,bearing_rad\n1,2.5,0.25\n2,3,-1\n"), read);
  EXPECT_EQ(Rows("#time_s;range_m;bearing_rad\n1;2.5;0.25\n2;3;-1\n"), read);
  EXPECT_EQ(Rows("# time_s,range_m,bearing_rad\ntime_s,range_m,bearing_rad\n1,2.5,0.25\n2,3,-1\n"), read)
      << "the one without a mark counts";
  EXPECT_EQ(Rows("# time_s,range_m,bearing_rad\n"), "");
}

// A landmark may be called '#1'.
TEST(CsvReader, WhereNamesComeFirstARowIsNoComment) {
  const TestFolder folder;
  BadLines bad(false);
  CsvReader reader(folder.Put("a.csv", "# all\nlandmark,x_m,y_m\n# measured twice\n#1,2,3\n"),
                   {{"landmark", "x_m", "y_m"}}, &bad);
  ASSERT_TRUE(reader.Next());
  EXPECT_EQ(reader.Text(0), "#1");
  EXPECT_EQ(reader.line(), 4U);
  EXPECT_FALSE(reader.Next());
}

TEST(CsvReader, ColumnsHaveLettersOfEitherCase) {
  EXPECT_EQ(Rows("Time_s,ROBOT,Range_MM,bearing_Deg\n1,Anna,2500,0\n"), "1 Anna 2.5 0\n");
  EXPECT_EQ(Rows("TIME_S,time_s,range_m,bearing_rad\n9,1,2,1\n"), "1 - 2 1\n") << "small ones count";
  ExpectContains(Rows("TIME_S,Time_s,range_m,bearing_rad\n"), "a.csv:1: the header has time_s twice");
  const TestFolder folder;
  BadLines bad(false);
  const CsvReader reader(folder.Put("a.csv", "Mood,A,Robot\n"), {{"a"}}, &bad);
  EXPECT_EQ(reader.extra_columns(), (std::vector<std::string>{"Mood", "Robot"})) << "names as they are";
}

TEST(CsvReader, AColumnMayBeMissing) {
  EXPECT_EQ(Rows("time_s,robot,range_m,bearing_rad\n1,anna,2,1\n"), "1 anna 2 1\n");
}

TEST(CsvReader, SaysHowToSkipBadLines) {
  ExpectContains(Rows("time_s,range_m,bearing_rad\nx,2,1\n"),
                 "(--skip-bad skips such lines and counts them)");
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
  ExpectContains(message("a,b\r1,2\r3,4\r"), "a.csv: its lines end in a carriage return alone");
  EXPECT_LT(message(std::string(1 << 20, 'x')).size(), 1000u) << "no line of a table";
  EXPECT_LT(message("a,b\n" + std::string(1 << 20, 'x') + ",1\n").size(), 1000u);
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
  ExpectContains(InputErrorOf([&] { ReadText(folder / "none.csv"); }),
                 "none.csv: cannot open: no such file or folder");
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
