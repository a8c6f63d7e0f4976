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
  const std::vector<std::pair<double, std::string>> leads = {{2.5, "low among the maps tried: 2.5"},
                                                             {5.0, "fair among the maps tried: 5.0"},
                                                             {57.25, "high among the maps tried: 57.2"}};
  for (const auto& [lead, word] : leads) {
    Blob result = Searched();
    result.PutScalar<double>("search/lead_nats", lead);
    EXPECT_EQ(ConfidenceText(result), word + " nats ahead of the next different one of 2 candidates");
  }
}

TEST(ConfidenceText, StartsThatAgreeAndASingleStart) {
  EXPECT_EQ(ConfidenceText(Searched()), "high among the maps tried: all 2 candidates found this one or none");
  EXPECT_EQ(ConfidenceText(Blob()), "not stated: there was one candidate, no other map to compare with");
}

}  // namespace
}  // namespace cairn::datasets
