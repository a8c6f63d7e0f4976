#include "datasets/confidence.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace cairn::datasets {
namespace {

Blob Searched() {
  Blob result;
  result.PutVector<double>("search/score_nats", {-10.0, -12.5});
  return result;
}

TEST(ConfidenceText, ALeadIsLowFairOrHigh) {
  const std::vector<std::pair<double, std::string>> leads = {
      {2.5, "low: 2.5"}, {5.0, "fair: 5.0"}, {57.25, "high: 57.2"}};
  for (const auto& [lead, word] : leads) {
    Blob result = Searched();
    result.PutScalar<double>("search/lead_nats", lead);
    EXPECT_EQ(ConfidenceText(result), word + " nats ahead of the next different map of 2 starts");
  }
}

TEST(ConfidenceText, StartsThatAgreeAndASingleStart) {
  EXPECT_EQ(ConfidenceText(Searched()), "high: all 2 starts found this map or none");
  EXPECT_EQ(ConfidenceText(Blob()), "not stated: there was one start, no other map to compare with");
}

}  // namespace
}  // namespace cairn::datasets
