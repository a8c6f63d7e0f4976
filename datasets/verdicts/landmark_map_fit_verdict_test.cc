// What a verdict makes of how well the observations and the odometry fit the map.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "datasets/verdicts/landmark_map_verdict.h"
#include "datasets/verdicts/testing_landmark_map.h"
#include "schema/kinds/landmark_map.h"

namespace cairn::datasets {
namespace {

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
