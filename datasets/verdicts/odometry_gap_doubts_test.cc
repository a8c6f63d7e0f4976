#include "datasets/verdicts/odometry_gap_doubts.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "datasets/verdicts/landmark_map_verdict.h"
#include "datasets/verdicts/testing_landmark_map.h"
#include "schema/kinds/landmark_map.h"

namespace cairn::datasets {
namespace {

// Names hold the two sides of a slip together; without any each side has landmarks of its own.
TEST(OdometryGapDoubts, OdometryThatDoesNotFitIsLowWhereNothingHasAName) {
  const auto slipped = [](const std::vector<std::int32_t>& identity, std::int64_t jumps) {
    Blob map = FittedMap(200, 0, 0, jumps);
    map.PutAll("", Searched(12, 57.25));
    map.PutVector("map/landmark_identity", identity);
    return LandmarkMapVerdict(map);
  };
  EXPECT_EQ(slipped({-1, -1}, 0).trust, Confidence::kHigh);
  EXPECT_EQ(slipped({-1, 0}, 1).trust, Confidence::kFair) << "one has a name";
  const Verdict nameless = slipped({-1, -1}, 1);
  EXPECT_EQ(nameless.trust, Confidence::kLow);
  EXPECT_NE(nameless.why.find("was it carried? Without names a slip makes landmarks that are not there"),
            std::string::npos)
      << nameless.why;
}

TEST(OdometryGapDoubts, HalvesThatOdometryAloneHoldsTogetherAreNotHigh) {
  const auto held = [](std::int64_t landmarks) {
    Blob map = FittedMap(200, 0, 0, 0);
    map.PutScalar<std::int64_t>("fit/fewest_common", landmarks);
    map.PutScalar<double>("fit/fewest_common_s", 61.5);
    return LandmarkMapVerdict(map);
  };
  EXPECT_EQ(held(2).trust, Confidence::kHigh);
  EXPECT_EQ(held(1).trust, Confidence::kFair);
  EXPECT_NE(held(1).why.find("by one landmark and odometry alone"), std::string::npos) << held(1).why;
  EXPECT_EQ(held(0).trust, Confidence::kFair);
  EXPECT_NE(held(0).why.find("before 61.5 s and after hangs together by odometry alone"), std::string::npos)
      << held(0).why;
}

TEST(OdometryGapDoubts, WhatOdometryLacksIsNeverHighAndLowWhereNothingElseTellsWhereItWentOn) {
  const auto lacks = [](std::int64_t shared, double lead_nats) {
    kinds::LandmarkMap map;
    map.holes.robot = std::vector<std::int32_t>{0, 0};
    map.holes.from_s = std::vector<double>{10, 140};
    map.holes.length_s = std::vector<double>{25, 20.1};
    map.holes.missing_m = std::vector<double>{2.0, 6.0};
    map.holes.shared_landmarks = std::vector<std::int64_t>{9, shared};
    map.holes.lead_nats = std::vector<double>{std::nan(""), lead_nats};
    Blob blob = FittedMap(200, 0, 0, 0);
    blob.PutAll("holes/", BlobOf(map).Sub("holes/"));
    return LandmarkMapVerdict(blob);
  };
  for (const Verdict& held : {lacks(2, std::nan("")), lacks(5, 10)}) {
    EXPECT_EQ(held.trust, Confidence::kFair);
    EXPECT_NE(
        held.why.find("the odometry of robot lacks 25.0 s from 10.0 s on, some 2.0 m of its way; it lacks "
                      "more 1 times"),
        std::string::npos)
        << held.why;
  }
  for (const Verdict& loose : {lacks(1, std::nan("")), lacks(5, 9.9)}) {
    EXPECT_EQ(loose.trust, Confidence::kLow);
    EXPECT_NE(
        loose.why.find("lacks 20.1 s from 140.0 s on, some 6.0 m of its way, and what it saw before and "
                       "after has too little in common"),
        std::string::npos)
        << loose.why;
  }
}

// A motion was left free; another one, in its place, would make another map.
TEST(OdometryGapDoubts, WhereItIsNotSureWhenOdometryBrokeTheMapIsLow) {
  const auto of = [](std::optional<double> lead_nats, std::int32_t identity) {
    Blob map = FittedMap(200, 0, 0, 0);
    map.PutVector<std::int32_t>("map/landmark_identity", {identity});
    map.PutScalar<std::int64_t>("fit/odometry_misfits", 1);
    map.PutScalar<double>("fit/worst_odometry_s", 164);
    if (lead_nats) map.PutScalar("fit/odometry_break_lead_nats", *lead_nats);
    return LandmarkMapVerdict(map);
  };
  EXPECT_EQ(of(std::nullopt, 0).trust, Confidence::kFair);
  EXPECT_EQ(of(10.0, 0).trust, Confidence::kFair);
  const Verdict unsure = of(2.3, 0);
  EXPECT_EQ(unsure.trust, Confidence::kLow);
  EXPECT_NE(unsure.why.find(
                "odometry does not fit once, worst at 164.0 s: did the robot slip, was it carried? It may "
                "have been another time, which makes another map, 2.3 nats behind"),
            std::string::npos)
      << unsure.why;
  const Verdict nameless = of(2.3, -1);
  EXPECT_EQ(nameless.trust, Confidence::kLow);
  EXPECT_NE(nameless.why.find("2.3 nats behind. Without names a slip makes"), std::string::npos)
      << nameless.why;
}

}  // namespace
}  // namespace cairn::datasets
