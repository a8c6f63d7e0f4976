#include "datasets/confidence.h"

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
  return result;
}

TEST(ConfidenceText, IsHighWhereManyStartsFoundTheMapAndItIsFarAhead) {
  EXPECT_EQ(ConfidenceText(Searched(3, 57.25)),
            "high: found from 3 of 12 starts, 57.2 nats ahead of the next different map");
  EXPECT_EQ(ConfidenceText(Searched(7, 4.5)),
            "fair: found from 7 of 12 starts, 4.5 nats ahead of the next different map");
  EXPECT_EQ(ConfidenceText(Searched(7, 2.5)),
            "low: found from 7 of 12 starts, 2.5 nats ahead of the next different map");
  EXPECT_EQ(ConfidenceText(Searched(2, 102.0)),
            "low: found from 2 of 12 starts, 102.0 nats ahead of the next different map");
}

TEST(ConfidenceText, StartsThatAgreeAndASingleStart) {
  EXPECT_EQ(ConfidenceText(Searched(12, 1.0).Without("search/lead_nats")),
            "high: found from 12 of 12 starts, no other map was found");
  EXPECT_EQ(ConfidenceText(Blob()), "not stated: there was one candidate, no other map to compare with");
}

TEST(ConfidenceText, AFileThatHoldsSomethingElseStatesNone) {
  Blob result;
  result.Put("search/support", Array::Text("three"));
  EXPECT_EQ(ConfidenceOf(result), Confidence::kNone);
  result.PutVector<double>("search/support", {3.0, 4.0});
  EXPECT_EQ(ConfidenceOf(result), Confidence::kNone);
}

}  // namespace
}  // namespace cairn::datasets
