#include "datasets/common/confidence.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace cairn::datasets {
namespace {

Blob Searched(int support, double lead_nats) {
  Blob result;
  result.PutScalar<std::int32_t>("search/support", support);
  result.PutScalar<std::int32_t>("search/starts", 12);
  result.PutScalar<double>("search/lead_nats", lead_nats);
  result.Put("search/unlike", Array::Texts({}));
  return result;
}

TEST(ConfidenceText, StatesARateOnlyOfWhatItWasMeasuredOn) {
  Blob result = Searched(7, 164.8);
  result.Put("search/unlike", Array::Texts({"it has 4 robots", "the option revise is not the default"}));
  EXPECT_EQ(ConfidenceText(result),
            "unknown: found from 7 of 12 starts, 164.8 nats ahead of the next different map; how often such "
            "maps are right was not measured (it has 4 robots, the option revise is not the default)");
  for (const std::string& text : {ConfidenceText(result), ConfidenceText(result.Without("search/unlike"))}) {
    EXPECT_EQ(text.find("right in"), std::string::npos) << text;
    EXPECT_EQ(text.find("high"), std::string::npos) << text;
  }
}

TEST(ConfidenceText, IsHighWhereManyStartsFoundTheMapAndItIsFarAhead) {
  EXPECT_EQ(
      ConfidenceText(Searched(3, 57.25)),
      "high (right in 99 of 100 such simulations): found from 3 of 12 starts, 57.2 nats ahead of the next "
      "different map");
  EXPECT_EQ(ConfidenceText(Searched(7, 4.5)),
            "fair (right in 9 of 10 such simulations): found from 7 of 12 starts, 4.5 nats ahead of the next "
            "different map");
  EXPECT_EQ(
      ConfidenceText(Searched(1, 102.0)),
      "low (right in 3 of 10 such simulations): found from 1 of 12 starts, 102.0 nats ahead of the next "
      "different map");
}

TEST(ReadConfidence, NeedsBothStartsThatAgreeAndALead) {
  EXPECT_EQ(ReadConfidence(Searched(3, 10.0)), Confidence::kHigh);
  EXPECT_EQ(ReadConfidence(Searched(3, 9.9)), Confidence::kFair);
  EXPECT_EQ(ReadConfidence(Searched(2, 99.0)), Confidence::kFair);
  EXPECT_EQ(ReadConfidence(Searched(2, 3.0)), Confidence::kFair);
  EXPECT_EQ(ReadConfidence(Searched(9, 2.9)), Confidence::kLow);
  EXPECT_EQ(ReadConfidence(Searched(1, 99.0)), Confidence::kLow);
}

TEST(ConfidenceText, StartsThatAgreeAndASingleStart) {
  EXPECT_EQ(ConfidenceText(Searched(12, 1.0).Without("search/lead_nats")),
            "high (right in 99 of 100 such simulations): found from 12 of 12 starts, no other map was found");
  Blob once;
  once.PutScalar<std::int32_t>("search/support", 1);
  once.PutScalar<std::int32_t>("search/starts", 1);
  EXPECT_EQ(
      ConfidenceText(once),
      "unknown: EM started once, no other map to compare with; it searches where the drift of the heading is "
      "stated at import (--heading-drift-rad-per-m), or with --set starts=10");
  EXPECT_EQ(ConfidenceText(Blob()), "not stated: there was no search");
}

TEST(ConfidenceText, AFileThatHoldsSomethingElseStatesNone) {
  Blob result;
  result.Put("search/support", Array::Text("three"));
  EXPECT_EQ(ReadConfidence(result), Confidence::kNone);
  result.PutVector<double>("search/support", {3.0, 4.0});
  EXPECT_EQ(ReadConfidence(result), Confidence::kNone);
}

TEST(NotRefined, SaysWhyAndWhetherItWasRefused) {
  Blob result;
  EXPECT_EQ(NotRefined(result), "") << "older files do not say";
  result.Put("refinement/reason", Array::Text("refused: the least squares has no solution"));
  EXPECT_EQ(NotRefined(result), "refused: the least squares has no solution");
  EXPECT_TRUE(RefinementRefused(result));
  result.Put("refinement/reason", Array::Text("not tried: refine=false"));
  EXPECT_EQ(NotRefined(result), "not tried: refine=false");
  EXPECT_FALSE(RefinementRefused(result));
  result.Put("refinement/reason", Array::Text(""));
  EXPECT_EQ(NotRefined(result), "");
  EXPECT_FALSE(RefinementRefused(result));
  result.PutVector<double>("refinement/reason", {1.0});
  EXPECT_EQ(NotRefined(result), "") << "a file may hold anything";
}

}  // namespace
}  // namespace cairn::datasets
