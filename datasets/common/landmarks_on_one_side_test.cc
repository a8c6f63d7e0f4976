#include "datasets/common/landmarks_on_one_side.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "datasets/common/landmark_map_verdict.h"

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
  EXPECT_EQ(VerdictOf(0, 0).trust, Confidence::kFair);
  EXPECT_EQ(VerdictOf(2, 0).trust, Confidence::kFair) << "two may be chance";
  EXPECT_EQ(VerdictOf(6, 3).trust, Confidence::kFair);
  EXPECT_EQ(VerdictOf(7, 3).trust, Confidence::kLow);
  const Verdict slipped = VerdictOf(12, 2);
  EXPECT_EQ(slipped.trust, Confidence::kLow);
  EXPECT_NE(slipped.why.find("; 12 of 14 landmarks were seen only before or only after 312.0 s, though the "
                             "robot looked at their places on both sides of it: it may have slipped or been "
                             "carried then"),
            std::string::npos)
      << slipped.why;
}

TEST(LandmarksOnOneSide, AreNoSignWhereSomeHaveNames) {
  EXPECT_EQ(VerdictOf(12, 2, {0, -1}).trust, VerdictOf(0, 0, {0, -1}).trust);
  EXPECT_EQ(VerdictOf(12, 2, {0, -1}).why.find("only before"), std::string::npos);
}

}  // namespace
}  // namespace cairn::datasets
