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

// What drifts in time, or repeats, leads robots astray that are sure.
TEST(LocalizationVerdict, IsLowWhereThoseThatAreSureAreElsewhere) {
  Blob result = Localized({2, 2, 2, 9}, 1.5);
  result.PutVector<double>("step/off_label_m", {9, 1, 9, 2.4, 9, 2.5, 9, 9});
  const Verdict right = LocalizationVerdict(result);
  EXPECT_EQ(right.trust, Confidence::kFair);
  EXPECT_EQ(right.why.find("only"), std::string::npos) << right.why;
  result.PutVector<double>("step/off_label_m", {9, 1, 9, 2.4, 9, 6, 9, 0});
  const Verdict most = LocalizationVerdict(result);
  EXPECT_EQ(most.trust, Confidence::kFair);
  EXPECT_NE(most.why.find("only 2 of those 3 are as near"), std::string::npos) << most.why;
  result.PutVector<double>("step/off_label_m", {0, 1, 0, 6, 0, 6, 0, 0});
  const Verdict few = LocalizationVerdict(result);
  EXPECT_EQ(few.trust, Confidence::kLow);
  EXPECT_NE(few.why.find("only 1 of those 3 are as near"), std::string::npos) << few.why;
  Blob half = Localized({2, 2, 2, 9, 9}, 1.5);
  half.PutVector<double>("step/off_label_m", {9, 1, 9, 1, 9, 6, 9, 9, 9, 9});
  EXPECT_EQ(LocalizationVerdict(half).trust, Confidence::kLow) << "two of five are where they are sure to be";
}

TEST(LocalizationVerdict, WhoIsAsFarOffAsItsOwnBeliefAllowsIsThere) {
  Blob result = Localized({2.2, 2.2, 2.2, 2.2}, 1.5);
  result.PutVector<double>("step/off_label_m", {9, 4, 9, 4, 9, 1, 9, 1});
  const Verdict right = LocalizationVerdict(result);
  EXPECT_EQ(right.trust, Confidence::kFair);
  EXPECT_EQ(right.why.find("only"), std::string::npos) << right.why;
}

TEST(LocalizationVerdict, IsNoBetterThanThatOfItsNetworks) {
  Blob result = Localized({2, 2, 2}, 1.5);
  result.PutVector<double>("step/off_label_m", std::vector<double>(6, 0));
  result.Put("extractors", Array::Texts({"networks", "networks_2"}));
  for (const char* networks : {"extractor/0/", "extractor/1/"}) {
    result.PutScalar(std::string(networks) + "held_out_reduction", 0.3);
    result.PutScalar(std::string(networks) + "training_reduction", 0.4);
  }
  EXPECT_EQ(LocalizationVerdict(result).trust, Confidence::kFair);
  result.Put("extractor/1/input_doubts", Array::Texts({"input 'seq' only grows"}));
  const Verdict clock = LocalizationVerdict(result);
  EXPECT_EQ(clock.trust, Confidence::kLow);
  EXPECT_NE(clock.why.find("input 'seq' only grows"), std::string::npos) << clock.why;
  result = result.Without("extractor/1/input_doubts");
  result.PutScalar("extractor/1/held_out_reduction", 0.0);
  EXPECT_EQ(LocalizationVerdict(result).trust, Confidence::kLow);
  Blob unknown = Localized({2, 2, 2}, 1.5);
  unknown.Put("extractors", Array::Texts({"networks"}));
  EXPECT_EQ(LocalizationVerdict(unknown).trust, Confidence::kFair) << "no run was held out of their training";
}

TEST(LocalizationVerdict, OfAnOlderFileIsNotKnown) {
  const Blob older = Localized({2}, 1).Without("step/lead_nats");
  EXPECT_EQ(LocalizationVerdict(older).trust, Confidence::kNone);
}

}  // namespace
}  // namespace cairn::datasets
