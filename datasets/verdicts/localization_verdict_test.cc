#include "datasets/verdicts/localization_verdict.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

namespace cairn::datasets {
namespace {

// Robots of two steps each that end with these spreads, among positions whose own is 10 m.
Blob Localized(const std::vector<double>& spread_m, double lead_nats) {
  Blob result;
  std::vector<std::int32_t> traverse;
  std::vector<double> spreads, lead, expected;
  for (std::size_t k = 0; k < spread_m.size(); ++k) {
    traverse.insert(traverse.end(), 2, static_cast<std::int32_t>(k));
    spreads.insert(spreads.end(), {10, spread_m[k]});
    lead.insert(lead.end(), {0, lead_nats});
    expected.insert(expected.end(), {0, 1});
  }
  const std::size_t steps = traverse.size();
  result.PutVector("step/traverse", traverse);
  for (const char* name : {"step/run", "step/sample"})
    result.PutVector(name, std::vector<std::int32_t>(steps));
  for (const char* name :
       {"step/travelled_m", "step/mean_x_m", "step/mean_y_m", "step/mode_x_m", "step/mode_y_m"})
    result.PutVector(name, std::vector<double>(steps));
  result.PutVector("step/spread_m", spreads);
  result.PutVector("step/entries", std::vector<std::int64_t>(steps, 0));
  result.PutVector("step/lead_nats", lead);
  result.PutVector("step/expected_lead_nats", expected);
  result.PutVector("belief/position", std::vector<std::int32_t>());
  result.PutVector("belief/probability", std::vector<float>());
  result.PutVector<double>("position/x_m", {-10, 10, 0, 0});
  result.PutVector<double>("position/y_m", {0, 0, -10, 10});
  return result;
}

TEST(LocalizationVerdict, IsByHowSureRobotsAreAndHowWellTheyForetell) {
  const Verdict fair = LocalizationVerdict(Localized({2, 2.4, 9}, 1.5));
  EXPECT_EQ(fair.trust, Confidence::kFair);
  EXPECT_EQ(fair.why.find("2 of 3 robots end sure of their place to within 2.5 m"), 0U) << fair.why;
  EXPECT_EQ(LocalizationVerdict(Localized({2, 2.6, 9}, 1.5)).trust, Confidence::kLow) << "most are lost";
  const Verdict elsewhere = LocalizationVerdict(Localized({2, 2, 2}, 0.9));
  EXPECT_EQ(elsewhere.trust, Confidence::kLow);
  EXPECT_NE(elsewhere.why.find("another place"), std::string::npos) << elsewhere.why;
}

// One of three runs was recorded in another frame, 15 m away: what is sure is measured by the others.
TEST(LocalizationVerdict, IsLowWhereTheMapLiesInTwoPlaces) {
  Blob result = Localized({2, 2, 2}, 1.5);
  std::vector<double> x_m, y_m;
  for (int k = 0; k < 180; ++k) {
    x_m.push_back(k % 30);
    y_m.push_back(k < 120 ? 0 : 15);
  }
  result.PutVector("position/x_m", x_m);
  result.PutVector("position/y_m", y_m);
  const Verdict apart = LocalizationVerdict(result);
  EXPECT_EQ(apart.trust, Confidence::kLow);
  EXPECT_NE(apart.why.find("to within 2.2 m"), std::string::npos) << apart.why;
  EXPECT_NE(apart.why.find("in 2 places with nothing between them, 120 in the largest and 60 in the next"),
            std::string::npos)
      << apart.why;
  result.PutVector("position/y_m", std::vector<double>(180, 0));
  EXPECT_EQ(LocalizationVerdict(result).trust, Confidence::kFair);
}

TEST(LocalizationVerdict, OfAnOlderFileIsNotKnown) {
  const Blob older = Localized({2}, 1).Without("step/lead_nats");
  EXPECT_EQ(LocalizationVerdict(older).trust, Confidence::kNone);
}

}  // namespace
}  // namespace cairn::datasets
