// What a verdict makes of how well the observations and the odometry fit the map.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "datasets/common/landmark_map_verdict.h"
#include "datasets/common/testing_landmark_map.h"
#include "schema/kinds/landmark_map.h"

namespace cairn::datasets {
namespace {

// With so many of `observations` misfits, and a map whose landmarks have names.
Blob FittedMap(std::int64_t observations, std::int64_t misfits, std::int64_t run, std::int64_t jumps,
               double worst_sigmas = 4, double range_found_m = 0.1) {
  kinds::LandmarkMap map;
  map.robots = std::vector<std::string>{"robot"};
  map.robot.resize(1);
  map.robot[0].map_landmark = std::vector<std::int32_t>(static_cast<std::size_t>(observations), 0);
  map.map.landmark_identity = std::vector<std::int32_t>{0};
  map.fit.observations = observations;
  map.fit.misfits = misfits;
  map.fit.longest_run = run;
  map.fit.longest_run_from_s = 12.5;
  map.fit.odometry_misfits = jumps;
  map.fit.worst_odometry_s = 20.0;
  map.fit.worst_sigmas = std::vector<double>{worst_sigmas};
  map.fit.worst_time_s = std::vector<double>{7.0};
  map.fit.kind = std::vector<std::string>{"range"};
  map.fit.stated = std::vector<double>{0.1};
  map.fit.found = std::vector<double>{range_found_m};
  return BlobOf(map);
}

// Posts in a row fit as well one post on.
TEST(LandmarkMapVerdict, AMapThatFitsAsWellWhenItIsShiftedAlongAPatternIsLow) {
  const auto shifted = [](double lead_nats, bool taken) {
    Blob map = FittedMap(200, 0, 0, 0);
    map.PutAll("", Searched(9, 57.25));
    map.PutVector<std::int32_t>("map/landmark_identity", {-1});
    map.PutScalar<double>("fit/shift_m", 2.97);
    map.PutScalar<double>("fit/shift_from_s", 3);
    map.PutScalar<double>("fit/shift_until_s", 81);
    map.PutScalar<double>("fit/shift_lead_nats", lead_nats);
    map.PutScalar<std::uint8_t>("fit/shift_taken", taken ? 1 : 0);
    return LandmarkMapVerdict(map);
  };
  const Verdict low = shifted(3.5, false);
  EXPECT_EQ(low.trust, Confidence::kLow);
  EXPECT_NE(
      low.why.find("landmarks stand in a regular pattern: a map in which what was seen from 3.0 to 81.0 "
                   "s is 3.0 m further on is 3.5 nats behind; a name for one or two landmarks"),
      std::string::npos)
      << low.why;
  EXPECT_EQ(shifted(3.5, true).trust, Confidence::kLow);
  EXPECT_NE(shifted(-1.5, false).why.find("is 1.5 nats ahead"), std::string::npos);
  EXPECT_EQ(shifted(10.5, false).trust, Confidence::kHigh);
  EXPECT_EQ(shifted(10.5, true).trust, Confidence::kFair);
  EXPECT_NE(shifted(10.5, true).why.find("EM's own map"), std::string::npos);
}

// Whichever of both says less.
TEST(LandmarkMapVerdict, OfLandmarksWithoutNamesAtADistanceTheSearchAndTheFitTell) {
  const auto searched = [](int support, double lead_nats, Blob map) {
    map.PutAll("", Searched(support, lead_nats));
    map.PutVector<std::int32_t>("map/landmark_identity", {-1});
    map.Put("search/unlike", Array::Texts({"landmarks are seen at a distance"}));
    return LandmarkMapVerdict(map);
  };
  const Verdict agreed = searched(5, 57.25, FittedMap(200, 1, 1, 0));
  EXPECT_EQ(agreed.trust, Confidence::kHigh);
  EXPECT_EQ(searched(3, 57.25, FittedMap(200, 1, 1, 0)).trust, Confidence::kHigh) << "of 12 starts";
  Blob some_false = FittedMap(200, 0, 0, 0);
  std::vector<std::int32_t> of(200, 0);
  std::fill_n(of.begin(), 5, -1);
  some_false.PutVector("robot/0/observations/map_landmark", of);
  EXPECT_EQ(searched(5, 57.25, some_false).trust, Confidence::kFair) << "where are the others?";
  Blob moved = FittedMap(200, 0, 0, 0);
  moved.PutScalar<std::int64_t>("fit/most_one_sided", 2);
  moved.PutScalar<double>("fit/most_one_sided_s", 61.5);
  EXPECT_EQ(searched(5, 57.25, moved).trust, Confidence::kFair);
  EXPECT_NE(searched(5, 57.25, moved)
                .why.find("2 landmarks were seen only before or only after 61.5 s, though the robot looked"),
            std::string::npos);
  EXPECT_EQ(agreed.why.find("found from 5 of 12 starts, 57.2 nats ahead of the next different map; 199 "
                            "observations fit the map; 1 of"),
            0U)
      << agreed.why;
  EXPECT_EQ(searched(1, 57.25, FittedMap(200, 1, 1, 0)).trust, Confidence::kLow);
  EXPECT_EQ(searched(5, 2.0, FittedMap(200, 1, 1, 0)).trust, Confidence::kLow);
  EXPECT_EQ(searched(5, 57.25, FittedMap(200, 10, 1, 0)).trust, Confidence::kFair);
  EXPECT_EQ(searched(5, 57.25, FittedMap(200, 50, 4, 0)).trust, Confidence::kLow);
  EXPECT_EQ(searched(7, 57.25, FittedMap(200, 0, 0, 0, 4, 0.25)).trust, Confidence::kFair);
  const Verdict few = searched(5, 57.25, FittedMap(200, 0, 0, 0, 4, 0.25));
  EXPECT_EQ(few.trust, Confidence::kLow) << "of 12 starts, and ranges err twice as much";
  EXPECT_NE(few.why.find("; most starts led to another map"), std::string::npos) << few.why;
  const Verdict said = searched(5, 57.25, FittedMap(200, 0, 0, 0, 4, 0.18));
  EXPECT_EQ(said.trust, Confidence::kHigh) << "as data sheets err";
  EXPECT_NE(said.why.find("err by 1.8 times"), std::string::npos) << said.why;
  Blob of_many = FittedMap(200, 0, 0, 0);
  of_many.PutAll("", Searched(3, 57.25));
  of_many.PutScalar<std::int32_t>("search/starts", 13);
  EXPECT_EQ(LandmarkMapVerdict(of_many).trust, Confidence::kFair);
  const Verdict carried = searched(5, 57.25, FittedMap(200, 0, 0, 1));
  EXPECT_EQ(carried.trust, Confidence::kLow) << "of 12 starts, and the path breaks";
  EXPECT_NE(carried.why.find("was it carried? Without names a slip makes landmarks that are not "
                             "there; most starts led to another map"),
            std::string::npos)
      << carried.why;
  EXPECT_EQ(searched(5, 57.25, FittedMap(200, 6, 6, 0)).trust, Confidence::kLow);
}

// Names hold the two sides of a slip together; without any each side has landmarks of its own.
TEST(LandmarkMapVerdict, OdometryThatDoesNotFitIsLowWhereNothingHasAName) {
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

TEST(LandmarkMapVerdict, OfNamedLandmarksTheFitTells) {
  EXPECT_EQ(
      TextOf(FittedMap(200, 1, 1, 0)),
      "high: 199 observations fit the map; 1 of 200 observations does not fit the map, the worst is 4.0 "
      "standard deviations off, at 7.0 s");
  EXPECT_EQ(LandmarkMapVerdict(FittedMap(20, 0, 0, 0)).trust, Confidence::kFair) << "too few to tell";
  EXPECT_EQ(LandmarkMapVerdict(FittedMap(200, 10, 1, 0)).trust, Confidence::kFair);
  EXPECT_EQ(LandmarkMapVerdict(FittedMap(200, 50, 4, 0)).trust, Confidence::kLow);
  EXPECT_EQ(LandmarkMapVerdict(FittedMap(200, 1, 1, 0, 7)).trust, Confidence::kFair) << "one is far off";
  EXPECT_EQ(LandmarkMapVerdict(FittedMap(200, 0, 0, 0, 4, 0.25)).trust, Confidence::kFair)
      << "ranges err twice as much";
  EXPECT_EQ(LandmarkMapVerdict(FittedMap(200, 0, 0, 0, 4, 0.5)).trust, Confidence::kLow)
      << "five times as much: of this sensor nothing is known";
  const Verdict moved = LandmarkMapVerdict(FittedMap(200, 6, 6, 0));
  EXPECT_EQ(moved.trust, Confidence::kFair);
  EXPECT_NE(moved.why.find("6 in a row do not from 12.5 s on"), std::string::npos) << moved.why;
  const Verdict slipped = LandmarkMapVerdict(FittedMap(200, 0, 0, 1));
  EXPECT_EQ(slipped.trust, Confidence::kFair);
  EXPECT_NE(slipped.why.find("odometry does not fit once, worst at 20.0 s"), std::string::npos)
      << slipped.why;
}

TEST(LandmarkMapVerdict, HalvesThatOdometryAloneHoldsTogetherAreNotHigh) {
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

TEST(LandmarkMapVerdict, WhatOdometryLacksIsNeverHighAndLowWhereNothingElseTellsWhereItWentOn) {
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
TEST(LandmarkMapVerdict, WhereItIsNotSureWhenOdometryBrokeTheMapIsLow) {
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

// As many robots as leads; below 0: another place, or none, is likelier.
Verdict WithLeads(const std::vector<double>& lead_nats, std::int64_t shared = 3,
                  std::int64_t one_sided = 11) {
  Blob map = FittedMap(200, 0, 0, 0);
  std::vector<std::string> robots;
  for (std::size_t r = 0; r < lead_nats.size(); ++r) {
    const std::string prefix = "robot/" + std::to_string(r) + "/";
    robots.push_back("rob" + std::to_string(r));
    map.PutVector<std::int32_t>(prefix + "observations/map_landmark", {0, 0});
    if (std::isnan(lead_nats[r])) continue;
    map.PutScalar<std::int64_t>(prefix + "shared_landmarks", shared);
    map.PutScalar<std::int64_t>(prefix + "one_sided_landmarks", one_sided);
    map.PutScalar<double>(prefix + "place_lead_nats", lead_nats[r]);
  }
  map.Put("robots", Array::Texts(robots));
  return LandmarkMapVerdict(map);
}

TEST(LandmarkMapVerdict, ARobotWhosePlaceIsUncertainIsNamed) {
  const Verdict loose = WithLeads({-25.6, -25.6});
  EXPECT_EQ(loose.trust, Confidence::kLow);
  EXPECT_NE(loose.why.find("; where rob1 is in the map of the others is uncertain: 3 landmarks in common, 11 "
                           "that one side alone has seen though the other looked there, 25.6 nats behind the "
                           "next place or none; two landmarks that both name would tell; the path of each "
                           "robot alone may be right"),
            std::string::npos)
      << loose.why;
  const Verdict placed_second = WithLeads({-5.2, std::nan("")});
  EXPECT_EQ(placed_second.trust, Confidence::kLow) << "the second one was the frame's";
  EXPECT_NE(placed_second.why.find("where rob0 is in the map"), std::string::npos) << placed_second.why;
  EXPECT_NE(WithLeads({5.0, 40.0, 9.9}).why.find("where rob0, rob2 is in"), std::string::npos);
  EXPECT_NE(WithLeads({5.0, 40.0, 9.9}).why.find("5.0 nats ahead of the next place"), std::string::npos);
  for (const Verdict& tied : {WithLeads({10.0, 10.0}, 14, 0), WithLeads({std::nan(""), std::nan("")})}) {
    EXPECT_GE(tied.trust, Confidence::kFair);
    EXPECT_EQ(tied.why.find("uncertain"), std::string::npos) << tied.why;
  }
}

// By how many nats they are where they are sooner than chance puts them there.
TEST(LandmarkMapVerdict, ARobotThatChanceMayHavePutThereIsNamed) {
  const auto with_odds = [](double odds_nats) {
    Blob map = FittedMap(200, 0, 0, 0);
    map.Put("robots", Array::Texts({"rob0", "rob1"}));
    for (const char* prefix : {"robot/0/", "robot/1/"}) {
      map.PutVector<std::int32_t>(std::string(prefix) + "observations/map_landmark", {0, 0});
      map.PutScalar<std::int64_t>(std::string(prefix) + "shared_landmarks", 4);
      map.PutScalar<std::int64_t>(std::string(prefix) + "one_sided_landmarks", 2);
      map.PutScalar<double>(std::string(prefix) + "place_lead_nats", 12);
      map.PutScalar<double>(std::string(prefix) + "place_odds_nats", odds_nats);
    }
    return LandmarkMapVerdict(map);
  };
  const Verdict chance = with_odds(-0.7);
  EXPECT_EQ(chance.trust, Confidence::kLow);
  EXPECT_NE(chance.why.find("where rob1 is in the map of the others may well be chance"), std::string::npos)
      << chance.why;
  EXPECT_EQ(with_odds(3).trust, Confidence::kFair);
  EXPECT_NE(with_odds(3).why.find("may be chance"), std::string::npos) << with_odds(3).why;
  EXPECT_EQ(with_odds(7).why.find("chance"), std::string::npos) << with_odds(7).why;
}

// The figures of two robots one of which saw all bearings a fifth too small, and of healthy ones.
TEST(LandmarkMapVerdict, LandmarksThatOneRobotAloneSawThoughTheOtherLookedThereAreADoubt) {
  const Verdict wrong = WithLeads({43.1, 43.1}, 13, 5);
  EXPECT_EQ(wrong.trust, Confidence::kLow);
  EXPECT_NE(wrong.why.find("rob1 and the others have 13 landmarks in common, and 5 that one side alone"),
            std::string::npos)
      << wrong.why;
  EXPECT_EQ(WithLeads({43.1, std::nan("")}, 13, 5).trust, Confidence::kLow);
  EXPECT_EQ(WithLeads({43.1, 43.1}, 20, 3).trust, Confidence::kFair);
  const Verdict twins =
      WithLeads({43.1, 43.1}, 7, 2);  // two halls alike but for one landmark, of a robot each
  EXPECT_EQ(twins.trust, Confidence::kFair);
  EXPECT_NE(twins.why.find("one side alone"), std::string::npos) << twins.why;
  for (const std::int64_t few : {0, 1, 2}) {
    const Verdict healthy = WithLeads({43.1, 43.1}, 14, few);
    EXPECT_GE(healthy.trust, Confidence::kFair);
    EXPECT_EQ(healthy.why.find("one side alone"), std::string::npos) << healthy.why;
  }
}

TEST(LandmarkMapVerdict, WhereMostObservationsAreOfNoLandmarkItIsLow) {
  const auto explained = [](const std::vector<std::int32_t>& landmark) {
    Blob map = FittedMap(200, 0, 0, 0);
    map.PutVector("robot/0/observations/map_landmark", landmark);
    return LandmarkMapVerdict(map);
  };
  EXPECT_EQ(explained({0, 0, -1, -1}).trust, Confidence::kFair);
  const Verdict noise = explained({0, -1, -1});
  EXPECT_EQ(noise.trust, Confidence::kLow);
  EXPECT_NE(noise.why.find("2 of 3 observations are of none of its landmarks"), std::string::npos)
      << noise.why;
}

// A sensor with many false observations that errs twice as much as was expected.
TEST(LandmarkMapVerdict, WhereMuchIsLeftOutASensorThatErrsMoreIsADoubt) {
  const auto seen = [](std::int32_t identity, std::size_t left_out, double range_found_m) {
    Blob map = FittedMap(200, 0, 0, 0, 4, range_found_m);
    map.PutAll("", Searched(12, 57.25));
    map.PutVector<std::int32_t>("map/landmark_identity", {identity});
    std::vector<std::int32_t> landmark(200, 0);
    std::fill_n(landmark.begin(), left_out, -1);
    map.PutVector("robot/0/observations/map_landmark", landmark);
    return LandmarkMapVerdict(map);
  };
  EXPECT_EQ(seen(-1, 40, 0.2).trust, Confidence::kFair);
  EXPECT_EQ(seen(-1, 41, 0.1).trust, Confidence::kFair);
  EXPECT_EQ(seen(0, 41, 0.2).trust, Confidence::kFair) << "names tell which is which";
  EXPECT_EQ(seen(-1, 41, 0.2).trust, Confidence::kLow);
}

TEST(LandmarkMapVerdict, AMountIsDoubtedWhereASensorErrsByFarMore) {
  const auto asks = [](double found_m, const char* what) {
    return TextOf(FittedMap(200, 0, 0, 0, 4, found_m)).find(what) != std::string::npos;
  };
  EXPECT_FALSE(asks(0.2, "mount"));
  EXPECT_TRUE(asks(0.2, "is the sensor less exact?"));
  EXPECT_TRUE(asks(0.31, "is the sensor's mount right?"));
}

TEST(LandmarkMapVerdict, DataThatNoPathExplainsAreLow) {
  Blob map;
  map.PutScalar<std::uint8_t>("refinement/done", 0);
  map.Put("refinement/reason", Array::Text("refused: odometry's ways or turns would be wrong by half"));
  EXPECT_EQ(
      TextOf(map),
      "low: there was no search; refinement was refused: odometry's ways or turns would be wrong by half, "
      "the landmarks stand where EM left them");
  map.Put("refinement/reason", Array::Text("refused: the least squares has no solution"));
  EXPECT_EQ(LandmarkMapVerdict(map).trust, Confidence::kNone);
  map.PutVector<double>("map/landmark_x_m", {});
  EXPECT_TRUE(TextOf(map).ends_with("has no solution, no landmark was found")) << TextOf(map);
}

TEST(LandmarkMapVerdict, AVagueMapIsNotHigh) {
  const auto spread = [](double sd_m, double extent_m = 10) {
    Blob map = FittedMap(200, 0, 0, 0);
    map.PutVector<double>("map/landmark_x_m", {0, extent_m});
    // Along a diagonal: the axes alone would say less.
    map.Put("map/landmark_covariance_m2", Array::Of<double>({1, 2, 2}, {sd_m * sd_m / 2, sd_m * sd_m / 2,
                                                                        sd_m * sd_m / 2, sd_m * sd_m / 2}));
    return LandmarkMapVerdict(map);
  };
  EXPECT_EQ(spread(0.4).trust, Confidence::kHigh);
  EXPECT_EQ(spread(0.45).trust, Confidence::kFair);
  EXPECT_EQ(spread(0.45, 100).trust, Confidence::kHigh) << "1.1 of 100 m";
  EXPECT_NE(spread(2).why.find("may be 4.9 m off"), std::string::npos) << spread(2).why;
}

// A person with a tag, among landmarks that stay.
TEST(LandmarkMapVerdict, OneLandmarkThatMostMisfitsAreOfIsNamed) {
  const auto moving = [](std::int64_t misfits, std::int64_t of_landmark, std::int64_t observations,
                         std::int32_t landmark = 1) {
    Blob map = FittedMap(200, misfits, 2, 0, 4, 1.64);
    map.Put("landmarks", Array::Texts({"door", "rosa"}));
    map.PutScalar<std::int32_t>("fit/misfit_landmark", landmark);
    map.PutScalar<std::int64_t>("fit/landmark_misfits", of_landmark);
    map.PutScalar<std::int64_t>("fit/landmark_observations", observations);
    return TextOf(map);
  };
  EXPECT_EQ(moving(20, 11, 30),
            "low: 180 observations fit the map; 20 of 200 observations do not fit the map, the worst is 4.0 "
            "standard deviations off, at 7.0 s; most of them are of landmark 'rosa': does it move, or one "
            "that is seen with it? Leave its rows out and look again; ranges or bearings err by 16.4 times "
            "what is stated");
  for (const std::string& text : {moving(20, 10, 30), moving(4, 4, 30), moving(20, 20, 100),
                                  moving(20, 11, 30, -1), TextOf(FittedMap(200, 20, 2, 0, 4, 1.64))}) {
    EXPECT_EQ(text.find("does it move"), std::string::npos) << text;
    EXPECT_NE(text.find("is the sensor's mount right?"), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace cairn::datasets
