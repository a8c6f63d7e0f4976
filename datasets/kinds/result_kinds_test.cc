#include "datasets/kinds/result_kinds.h"

#include <gtest/gtest.h>

#include <algorithm>

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
