#include "schema/command_line/command.h"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace cairn::cli {
namespace {

// What is said of `--value TEXT`; empty where it is taken.
template <class T>
std::string Complaint(const std::string& text, const std::function<void(Argument)>& limit) {
  CLI::App app;
  T value{};
  limit(Command(&app).Add("--value", value, "a number"));
  try {
    app.parse("--value=" + text);
  } catch (const CLI::ParseError& error) {
    return error.what();
  }
  return "";
}

TEST(Argument, BoundsOfNumbersAreSaidInFewDigits) {
  const auto not_negative = [](Argument argument) { argument.NotNegative(); };
  for (const char* text : {"-1", "inf", "nan", "wide"})
    EXPECT_EQ(Complaint<double>(text, not_negative),
              "--value: '" + std::string(text) + "' is not allowed; allowed: a number of at least 0");
  for (const char* text : {"0", "1e308", "0.25"}) EXPECT_EQ(Complaint<double>(text, not_negative), "");

  const auto positive = [](Argument argument) { argument.Positive(); };
  EXPECT_EQ(Complaint<double>("0", positive), "--value: '0' is not allowed; allowed: a number above 0");
  EXPECT_EQ(Complaint<double>("1e-9", positive), "");

  const auto hour = [](Argument argument) { argument.Within(0.001, 3600.0); };
  for (const char* text : {"3601", "nan"})
    EXPECT_EQ(Complaint<double>(text, hour),
              "--value: '" + std::string(text) + "' is not allowed; allowed: a number from 0.001 to 3600");
  EXPECT_EQ(Complaint<double>("3600", hour), "");

  const auto workers = [](Argument argument) { argument.Within(1, 1'000'000); };
  EXPECT_EQ(Complaint<int>("0", workers),
            "--value: '0' is not allowed; allowed: a whole number from 1 to 1000000");
  EXPECT_EQ(Complaint<int>("1000000", workers), "");
}

TEST(Argument, HelpSaysTheBoundsOfANumber) {
  CLI::App app;
  double value = 0;
  Command(&app).Add("--some", value, "a number").NotNegative();
  Command(&app).Add("--few", value, "a number").Within(1.0, 5.0);
  const std::string help = app.help();
  EXPECT_NE(help.find("--some FLOAT:NONNEGATIVE"), std::string::npos) << help;
  EXPECT_NE(help.find("--few FLOAT:FLOAT in [1 - 5]"), std::string::npos) << help;
}

// What is said of these words of a program with the command `put`; empty where they are taken, then in `out`.
std::string ComplaintOf(std::vector<const char*> words, std::string* out) {
  CLI::App app;
  app.fallthrough();
  bool verbose = false, force = false;
  std::string name;
  int count = 0;
  Command(&app).AddFlag("-v,--verbose", verbose, "say more");
  const Command put = Command(&app).AddCommand("put", "puts");
  put.Add("-o,--out", *out, "where");
  put.Add("--count", count, "how many");
  put.AddFlag("--force", force, "even so");
  put.Add("NAME", name, "what");
  words.insert(words.begin(), "program");
  try {
    Parse(app, static_cast<int>(words.size()), words.data());
  } catch (const CLI::ParseError& error) {
    return error.what();
  }
  return "";
}

TEST(Parse, NoOptionTakesTheNextOneForItsValue) {
  std::string out;
  const std::string empty = "--out: nothing is given (an empty word)";
  EXPECT_EQ(ComplaintOf({"put", "--out=", "--force"}, &out), empty);
  EXPECT_EQ(ComplaintOf({"put", "--out=", "here"}, &out), empty);
  EXPECT_EQ(ComplaintOf({"put", "--out="}, &out), empty);
  EXPECT_EQ(ComplaintOf({"put", "--out", ""}, &out), empty);
  EXPECT_EQ(ComplaintOf({"put", "--out", "a", "--count=", "3"}, &out),
            "--count: nothing is given (an empty word)");
  EXPECT_EQ(ComplaintOf({"put", "--out", "--force"}, &out), "--out: nothing is given, '--force' comes next");
  EXPECT_EQ(ComplaintOf({"put", "-o", "--count=3"}, &out), "-o: nothing is given, '--count=3' comes next");
  // Of the command above too.
  EXPECT_EQ(ComplaintOf({"put", "--out", "-v"}, &out), "--out: nothing is given, '-v' comes next");
  EXPECT_EQ(ComplaintOf({"put", "--out", "--", "x"}, &out), "--out: nothing is given, '--' comes next");
  EXPECT_NE(ComplaintOf({"put", "x", "--out"}, &out), "");
}

TEST(Parse, WhatIsNoOptionIsAValue) {
  std::string out;
  for (const auto& [words, value] : std::vector<std::pair<std::vector<const char*>, const char*>>{
           {{"put", "--out=--force", "--force"}, "--force"},
           {{"put", "--out", "--unknown"}, "--unknown"},
           {{"put", "--out", "put", "--force"}, "put"},
           {{"put", "--out", "a=", "--force"}, "a="},
           {{"put", "--out", "a", "--", "--force="}, "a"},
           {{"-v", "put", "-o", "-", "-v"}, "-"}}) {
    out.clear();
    EXPECT_EQ(ComplaintOf(words, &out), "");
    EXPECT_EQ(out, value);
  }
}

}  // namespace
}  // namespace cairn::cli
