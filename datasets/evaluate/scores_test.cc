#include "datasets/evaluate/scores.h"

#include <gtest/gtest.h>

namespace cairn::datasets {
namespace {

TEST(Scores, NestForProgramsAndHaveUnitsForPeople) {
  Scores scores;
  scores.Add("landmarks.found", std::int64_t{3}, " of 4 observed");
  scores.Add("landmarks.rmse_m", 0.25);
  scores.Add("correct", true);
  scores.Add("turned_rad", 0.5);
  EXPECT_EQ(scores.ToJson(-1), R"({"landmarks":{"found":3,"rmse_m":0.25},"correct":true,"turned_rad":0.5})");
  EXPECT_EQ(scores.ToText(),
            "landmarks.found                 3 of 4 observed\n"
            "landmarks.rmse_m                0.250 m\n"
            "correct                         yes\n"
            "turned_deg                      28.65 degrees\n");
}

TEST(Scores, WhatIsNotThereIsNullAndUnknown) {
  Scores scores;
  scores.Add("rmse_m", OrNone(std::optional<double>()));
  scores.Add("cells", {}, "unknown: the truth has no walls");
  scores.Add("share", ShareOf(0, 0));
  EXPECT_EQ(scores.ToJson(-1), R"({"rmse_m":null,"cells":null,"share":null})");
  EXPECT_EQ(scores.ToText(),
            "rmse_m                          unknown\n"
            "cells                           unknown: the truth has no walls\n"
            "share                           unknown\n");
}

TEST(Scores, SharesAreReadInPercentAndNothingIsMinusZero) {
  Scores scores;
  scores.Add("wrong_share", ShareOf(1, 8));
  scores.Add("gained", Share{-1e-9});
  scores.Add("off_m", -0.0001);
  EXPECT_EQ(scores.ToJson(-1), R"({"wrong_share":0.125,"gained":-1e-09,"off_m":-0.0001})");
  EXPECT_EQ(scores.ToText(),
            "wrong_share                     12.5%\n"
            "gained                          0.0%\n"
            "off_m                           0.000 m\n");
}

TEST(Scores, RowsAreATableForPeople) {
  Scores near, far, hidden;
  near.Add("window_m", 1.0);
  near.Add("error", Interval{0.5, 1});
  near.AddForPrograms("clusters", std::int64_t{7});
  far.Add("window_m", {}, "global");
  far.Add("error", {});
  far.AddForPrograms("clusters", std::int64_t{7});
  hidden.Add("window_m", 2.0);
  hidden.LeaveToPrograms();
  Scores scores;
  scores.AddRows("windows", {near, hidden, far});
  scores.AddRowsForPrograms("runs", {});
  scores.AddForPeople("95% intervals", "over 2 runs");
  EXPECT_EQ(scores.ToJson(-1),
            R"({"windows":[{"window_m":1.0,"error":[0.5,1.0],"clusters":7},{"window_m":2.0},)"
            R"({"window_m":null,"error":null,"clusters":7}],"runs":[]})");
  EXPECT_EQ(scores.ToText(),
            "windows\n"
            "  window_m  error\n"
            "  1.000     [0.5000, 1.0000]\n"
            "  global    unknown\n"
            "95% intervals                   over 2 runs\n");
}

TEST(Scores, ColumnsOfATableAreAsWideAsTheirCharacters) {
  Scores scores, one, other;
  one.Add("robot", std::string("Ömer 2"));
  one.Add("poses", std::int64_t{3});
  other.Add("robot", std::string("Anna 1"));
  other.Add("poses", std::int64_t{4});
  scores.AddRows("robots", {one, other});
  EXPECT_EQ(scores.ToText(),
            "robots\n"
            "  robot   poses\n"
            "  Ömer 2  3\n"
            "  Anna 1  4\n");
}

TEST(Scores, GroupsStandUnderTheirName) {
  Scores layer, scores;
  layer.Add("cells.free", std::int64_t{2});
  scores.AddGroup("most_likely", layer);
  EXPECT_EQ(scores.ToJson(-1), R"({"most_likely":{"cells":{"free":2}}})");
  EXPECT_EQ(scores.ToText(), "most_likely.cells.free          2\n");
}

TEST(Scores, AreComparedByTheirNames) {
  Scores a, b;
  a.Add("landmarks.found", std::int64_t{3}, " of 4 observed");
  a.Add("turned_rad", 0.5);
  a.Add("share", Share{0.25});
  a.Add("correct", false);
  a.AddRows("robots", {Scores()});
  a.Add("only_a_m", 1.0);
  b.Add("share", Share{0.125});
  b.Add("landmarks.found", std::int64_t{4}, " of 4 observed");
  b.Add("turned_rad", 0.5);
  b.Add("correct", true);
  b.Add("only_b_s", OrNone(std::optional<double>()));
  using Row = std::array<std::string, 4>;
  EXPECT_EQ(Scores::Compared(a, b),
            (std::vector<Row>{{"landmarks.found", "3 of 4 observed", "4 of 4 observed", "+1"},
                              {"turned_deg", "28.65 degrees", "28.65 degrees", "0.00"},
                              {"share", "25.0%", "12.5%", "-12.5"},
                              {"correct", "no", "yes", ""},
                              {"only_a_m", "1.000 m", "", ""},
                              {"only_b_s", "", "unknown", ""}}));
}

}  // namespace
}  // namespace cairn::datasets
