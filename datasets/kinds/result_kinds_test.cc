#include "datasets/kinds/result_kinds.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "datasets/evaluate/testing/grid.h"
#include "datasets/evaluate/testing/perfect_result.h"
#include "datasets/simulate/loop.h"
#include "schema/kinds/kind.h"

namespace cairn::datasets {
namespace {

TEST(ResultKinds, AreKindsOfFilesWithAPageAndAPicture) {
  for (const ResultKind& row : ResultKinds()) {
    EXPECT_NE(FindKind(row.name), nullptr) << row.name;
    EXPECT_NE(row.page, nullptr) << row.name;
    EXPECT_NE(row.picture, nullptr) << row.name;
    EXPECT_EQ(row.evaluate == nullptr, row.made_of.empty()) << row.name;
    EXPECT_EQ(FindResultKind(row.name), &row);
  }
  EXPECT_EQ(FindResultKind("log"), nullptr);
}

// What a pipeline makes must be looked at and judged.
TEST(ResultKinds, EveryKindThatIsNotGivenHasARow) {
  for (const Kind& kind : Kinds()) {
    if (kind.is_given) continue;
    EXPECT_NE(FindResultKind(kind.name), nullptr) << kind.name;
  }
}

TEST(ResultKinds, OfAGridMapOnlyCellsOfWhichSomethingIsKnownAreOccupied) {
  Blob map = DrawnMap({"##..", "#.##"}, 0.5);
  const auto occupied = [&map] { return FindResultKind("grid_map")->summary(map).ToText(10); };
  EXPECT_NE(occupied().find("2.0 by 1.0 m in cells of 0.5 m, 5 of them occupied"), std::string::npos)
      << occupied();
  map.Put("map/grid/log_odds_difference", Array::Of<double>({2, 4}, {3, -2, 0.009, 0, 4, -0.005, -5, 0.01}));
  EXPECT_NE(occupied().find(" 2 of them occupied"), std::string::npos) << occupied();
}

TEST(ResultKinds, ALandmarkMapSaysWhatWasFoundAndIsScoredAgainstItsLog) {
  const Blob log = SimulateLoop({.seed = 3}), map = PerfectLandmarkMap(log);
  const ResultKind& row = *FindResultKind("landmark_map");
  EXPECT_TRUE(row.has_truth(log));
  EXPECT_FALSE(row.has_truth(log.Without("truth/")));
  EXPECT_EQ(std::get<Evaluation>(row.evaluate(map, log, {})).landmarks->missed, 0);
  EXPECT_NE(row.summary(map).ToText(10).find(" in 1 iteration, log-likelihood "), std::string::npos);
}

}  // namespace
}  // namespace cairn::datasets
