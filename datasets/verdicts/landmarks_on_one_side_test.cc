#include "datasets/verdicts/landmarks_on_one_side.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "datasets/verdicts/landmark_map_verdict.h"

namespace cairn::datasets {
namespace {

// A map that fits and that all starts have found, with so many landmarks on one side and on both.
Verdict VerdictOf(std::int64_t one_sided, std::int64_t two_sided,
                  const std::vector<std::int32_t>& identity = {-1, -1}) {
  kinds::LandmarkMap map;
  map.robots = std::vector<std::string>{"robot"};
  map.robot.resize(1);
  map.robot[0].map_landmark = std::vector<std::int32_t>(200, 0);
  map.map.landmark_identity = identity;
  map.search.support = 12;
  map.search.starts = 12;
  map.fit.observations = 200;
  map.fit.misfits = 0;
  map.fit.longest_run = 0;
  if (one_sided > 0) {
    map.fit.one_sided = one_sided;
    map.fit.two_sided = two_sided;
    map.fit.one_sided_s = 312.0;
  }
  return LandmarkMapVerdict(BlobOf(map));
}

TEST(LandmarksOnOneSide, AreALowMapWhereTheyAreThreeAndMoreThanTwiceTheOthers) {
  EXPECT_EQ(VerdictOf(0, 0).trust, Confidence::kHigh);
  EXPECT_EQ(VerdictOf(2, 0).trust, Confidence::kHigh) << "two may be chance";
  EXPECT_EQ(VerdictOf(6, 3).trust, Confidence::kHigh);
  EXPECT_EQ(VerdictOf(7, 3).trust, Confidence::kLow);
  const Verdict slipped = VerdictOf(12, 2);
  EXPECT_EQ(slipped.trust, Confidence::kLow);
  EXPECT_NE(slipped.why.find("; 12 of 14 landmarks were seen only before or only after 312.0 s, though the "
                             "robot looked at their places on both sides of it: it may have slipped or been "
                             "carried then"),
            std::string::npos)
      << slipped.why;
}

// A robot that sees one landmark after the other: 20 times each of `before`, then of `after`.
Verdict WhereSeen(const std::vector<std::int32_t>& before, const std::vector<std::int32_t>& after,
                  std::int32_t identity = -1, const std::vector<std::int32_t>& other = {},
                  std::optional<double> lead_nats = {}) {
  kinds::LandmarkMap map;
  map.robots = std::vector<std::string>{"robot", "other"};
  map.robot.resize(2);
  std::vector<std::int32_t> seen;
  for (const auto* side : {&before, &after})
    for (int k = 0; k < 20; ++k) seen.insert(seen.end(), side->begin(), side->end());
  map.map.landmark_identity = std::vector<std::int32_t>{identity, -1, -1, -1, -1, -1};
  if (identity >= 0) map.map.landmark_identity = std::vector<std::int32_t>(6, identity);
  map.search.support = 12;
  map.search.starts = 12;
  map.fit.observations = static_cast<std::int64_t>(seen.size());
  map.fit.misfits = 0;
  map.fit.longest_run = 0;
  map.robot[0].map_landmark = seen;
  map.robot[1].map_landmark = other;
  if (lead_nats) map.fit.few_common_lead_nats = *lead_nats;
  return LandmarkMapVerdict(BlobOf(map));
}

TEST(FewInCommon, AreALowMapWhereNoMoreThanHalfOfThemAreSeenOnBothSides) {
  EXPECT_EQ(WhereSeen({0, 1, 2, 3}, {0, 1, 2, 3}).trust, Confidence::kHigh);
  EXPECT_EQ(WhereSeen({0, 1, 2, 3}, {1, 2, 3, 4, 5}).trust, Confidence::kHigh) << "three of four";
  EXPECT_EQ(WhereSeen({0, 1}, {4, 5}).trust, Confidence::kHigh) << "so few may be chance";
  const Verdict slipped = WhereSeen({0, 1, 2, 3}, {2, 3, 4, 5});
  EXPECT_EQ(slipped.trust, Confidence::kLow);
  EXPECT_NE(slipped.why.find("; only 2 of the 4 landmarks on one side of observation 78 were seen on the "
                             "other side, too"),
            std::string::npos)
      << slipped.why;
  EXPECT_GE(WhereSeen({0, 1, 2, 3}, {2, 3, 4, 5}, 0).trust, Confidence::kFair) << "names tell";
}

TEST(FewInCommon, CountWhatAnotherRobotSawOfBothSides) {
  EXPECT_EQ(WhereSeen({0, 1, 2, 3}, {2, 3, 4, 5}, -1, {0, 1, 4}).trust, Confidence::kLow) << "one beyond";
  EXPECT_EQ(WhereSeen({0, 1, 2, 3}, {2, 3, 4, 5}, -1, {0, 1, 2, 3, 4, 5}).trust, Confidence::kHigh);
}

// A robot that went on: it never looks back, yet what it sees then lies in one way alone to what it saw.
TEST(FewInCommon, AreNoDoubtWhereTheyTieBothSides) {
  const auto tied = [](double lead_nats) { return WhereSeen({0, 1, 2, 3}, {2, 3, 4, 5}, -1, {}, lead_nats); };
  EXPECT_EQ(tied(9.9).trust, Confidence::kLow);
  EXPECT_EQ(tied(10).trust, Confidence::kHigh);
  EXPECT_EQ(tied(10).why.find("on the other side"), std::string::npos) << tied(10).why;
}

TEST(LandmarksOnOneSide, AreNoSignWhereSomeHaveNames) {
  EXPECT_EQ(VerdictOf(12, 2, {0, -1}).trust, VerdictOf(0, 0, {0, -1}).trust);
  EXPECT_EQ(VerdictOf(12, 2, {0, -1}).why.find("only before"), std::string::npos);
}

}  // namespace
}  // namespace cairn::datasets
