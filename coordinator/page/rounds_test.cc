#include "coordinator/page/rounds.h"

#include <gtest/gtest.h>

namespace cairn::page {
namespace {

wire::LogLine Line(std::uint64_t number, const std::string& text) {
  wire::LogLine line;
  line.set_number(number);
  line.set_level("info");
  line.set_text(text);
  return line;
}

std::string RoundText(int round, const std::string& note) {
  return "stage 'map', round " + std::to_string(round) + ": 12 tasks in 0.8 s, 3.1 s of work: " + note;
}

TEST(ReadRoundLine, ReadsWhatTheCoordinatorWrites) {
  RoundLine round;
  ASSERT_TRUE(ReadRoundLine(RoundText(3, "iteration 3: log-likelihood -1234.56, 12 landmarks"), &round));
  EXPECT_EQ(round.stage, "map");
  EXPECT_EQ(round.number, 3u);
  EXPECT_EQ(round.tasks, 12u);
  EXPECT_DOUBLE_EQ(round.seconds, 0.8);
  EXPECT_DOUBLE_EQ(round.work_s, 3.1);
  ASSERT_EQ(round.figures.size(), 1u);
  EXPECT_EQ(round.figures[0].name, "log-likelihood");
  EXPECT_DOUBLE_EQ(round.figures[0].value, -1234.56);
  ASSERT_TRUE(ReadRoundLine("stage 'a', round 0: 1 task in 0.0 s, 0.0 s of work", &round));
  EXPECT_EQ(round.note, "");
}

TEST(ReadRoundLine, OtherLinesAreNoRounds) {
  RoundLine round;
  for (const char* text :
       {"", "stage 'map' begins, planned in 0.1 s", "stage 'map', round",
        "stage 'map', round x: 1 task in 1 s", "stage 'map', round 1: 12 tasks in nan s, 3.1 s of work",
        "stage 'map', round -1: 1 task in 0.1 s, 0.1 s of work",
        "stage 'map', round 1e300: 1 task in 0.1 s, 0.1 s of work", "submitted by desk"})
    EXPECT_FALSE(ReadRoundLine(text, &round)) << text;
}

TEST(FiguresIn, NotesOfEachPipelineThatHasAnyAreKnown) {
  const auto figures = FiguresIn("step 7: error 0.123 m of 0.456 m, reduced by 73.0%; held out 70.1%");
  ASSERT_EQ(figures.size(), 3u);
  EXPECT_EQ(figures[0].name, "posterior error");
  EXPECT_EQ(figures[0].unit, "m");
  EXPECT_EQ(figures[1].value, 70.1);
  EXPECT_EQ(figures[1].unit, "%");
  EXPECT_EQ(FiguresIn("search 4, log-likelihood -10.5, 31 obstacles; x")[0].value, -10.5);
  EXPECT_TRUE(FiguresIn("terror 5, 12 scans, error none").empty());
}

TEST(JobHistory, LinesThatComeTwiceCountOnceAndOldOnesGo) {
  JobHistory history;
  history.Add({Line(1, RoundText(0, "x")), Line(2, "y")});
  history.Add({Line(2, "y"), Line(3, RoundText(1, "x"))});
  EXPECT_EQ(history.last(), 3u);
  EXPECT_EQ(history.lines().size(), 3u);
  EXPECT_EQ(history.rounds().size(), 2u);
  for (std::uint64_t number = 4; number < 10'004;) {
    std::vector<wire::LogLine> lines;
    for (int i = 0; i < 100; ++i, ++number)
      lines.push_back(Line(number, RoundText(static_cast<int>(number), "x")));
    history.Add(lines);
  }
  EXPECT_EQ(history.lines().size(), 2000u);
  EXPECT_EQ(history.rounds().size(), 5000u) << "a curve is longer than what is shown of the log";
  EXPECT_EQ(history.last(), 10'003u);
}

TEST(ChartsHtml, DrawsEachFigureAndSaysTheLastWithItsUnit) {
  std::vector<RoundLine> rounds;
  EXPECT_EQ(ChartsHtml(rounds), "");
  for (int i = 0; i < 2000; ++i) {
    rounds.push_back({.stage = "map", .number = static_cast<std::uint64_t>(i), .seconds = 0.5});
    rounds.back().figures = {{"log-likelihood", "nats", -2000.0 + i}};
  }
  const std::string html = ChartsHtml(rounds);
  EXPECT_NE(html.find("<b>-1 nats</b>"), std::string::npos) << html.substr(0, 300);
  EXPECT_NE(html.find("time a round took"), std::string::npos);
  EXPECT_LT(html.size(), 20'000u) << "a long curve is thinned";
  EXPECT_EQ(html.find("nan"), std::string::npos);
  EXPECT_NE(html.find(" 1999,-1\""), std::string::npos) << "what one who points at it is told";
  rounds.resize(1);
  EXPECT_EQ(ChartsHtml(rounds), "") << "a point is no curve";
}

TEST(RoundsCsv, HasARowForEachFigureOfEachRound) {
  std::vector<RoundLine> rounds(1, {.stage = "a,b", .number = 7, .seconds = 0.5, .work_s = 2, .tasks = 3});
  rounds[0].figures = {{"log-likelihood", "nats", -2.25}};
  EXPECT_EQ(RoundsCsv(rounds),
            "stage,round,tasks,figure,value,unit\na_b,7,3,time a round took,0.5,s\na_b,7,3,work,2,s\n"
            "a_b,7,3,log-likelihood,-2.25,nats\n");
}

TEST(ChartsHtml, ACurveThatDoesNotChangeIsDrawn) {
  std::vector<RoundLine> rounds(2, {.stage = "<b>", .number = 1});
  rounds[1].number = 2;
  const std::string html = ChartsHtml(rounds);
  EXPECT_NE(html.find("class=\"curve\""), std::string::npos);
  EXPECT_EQ(html.find("nan"), std::string::npos);
  EXPECT_EQ(html.find("inf"), std::string::npos);
  EXPECT_EQ(html.find("<b>:"), std::string::npos);
}

}  // namespace
}  // namespace cairn::page
