#include "datasets/verdicts/grid_map_verdict.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <utility>

namespace cairn::datasets {
namespace {

TEST(GridMapVerdict, CountsTheReadingsThatTheMapExplains) {
  Blob result;
  result.Put("robots", Array::Texts({"robot"}));
  // A cell, nothing detected, random, not used, lost, beyond the map.
  result.Put("robot/0/laser/cause", Array::Of<std::int32_t>({1, 6}, {7, -1, -2, -3, -4, -5}));
  const Verdict verdict = GridMapVerdict(result);
  EXPECT_EQ(verdict.trust, Confidence::kNone);
  EXPECT_NE(verdict.why.find("it explains 50.0% of 4 readings"), std::string::npos) << verdict.why;
}

TEST(GridMapVerdict, SaysHowWellReadingsThatWereLeftOutAreForetold) {
  Blob result;
  result.PutScalar<std::int64_t>("fit/checked_readings", 900);
  result.PutScalar<double>("fit/checked_nats", 0.5);
  result.PutScalar<double>("fit/ignorant_nats", -1.25);
  Verdict verdict = GridMapVerdict(result);
  EXPECT_EQ(verdict.trust, Confidence::kNone);
  EXPECT_EQ(verdict.why.find("900 readings that were left out are each 1.75 nats likelier"), 0U)
      << verdict.why;
  EXPECT_EQ(verdict.numbers.at(1), (std::pair<std::string, double>("checked_gain_nats", 1.75)));
  EXPECT_EQ(verdict.why.find("its search ended"), std::string::npos);
  result.PutScalar<std::uint8_t>("search/cut_short", 1);
  EXPECT_NE(GridMapVerdict(result).why.find("its search ended because 'rounds'"), std::string::npos);
  result.PutScalar<double>("fit/ignorant_nats", 0.45);
  verdict = GridMapVerdict(result);
  EXPECT_EQ(verdict.trust, Confidence::kLow);
  EXPECT_NE(verdict.why.find("hardly likelier"), std::string::npos) << verdict.why;
}

}  // namespace
}  // namespace cairn::datasets
