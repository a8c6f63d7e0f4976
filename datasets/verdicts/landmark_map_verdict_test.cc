#include "datasets/verdicts/landmark_map_verdict.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "datasets/verdicts/testing_landmark_map.h"

namespace cairn::datasets {
namespace {

TEST(LandmarkMapVerdict, StatesARateOnlyOfWhatItWasMeasuredOn) {
  Blob result = Searched(7, 164.8);
  result.Put("search/unlike", Array::Texts({"it has 4 robots", "the option revise is not the default"}));
  EXPECT_EQ(
      TextOf(result),
      "not known: found from 7 of 12 starts, 164.8 nats ahead of the next different map; how often such "
      "maps are right was not measured (it has 4 robots, the option revise is not the default)");
  for (const std::string& text : {TextOf(result), TextOf(result.Without("search/unlike"))}) {
    EXPECT_EQ(text.find("right in"), std::string::npos) << text;
    EXPECT_EQ(text.find("high"), std::string::npos) << text;
  }
}

TEST(LandmarkMapVerdict, WhatTheObservationsSayOfThemselvesMakesItLow) {
  Blob result = Searched(7, 164.8);
  EXPECT_EQ(LandmarkMapVerdict(result).trust, Confidence::kHigh);
  result.Put("observation_doubts", Array::Texts({"robot 'one': all bearings are 0 rad"}));
  EXPECT_EQ(LandmarkMapVerdict(result).trust, Confidence::kLow);
  EXPECT_NE(TextOf(result).find("; robot 'one': all bearings are 0 rad"), std::string::npos)
      << TextOf(result);
}

TEST(LandmarkMapVerdict, OfContactsOfSeveralRobotsTheirPlacesTellToo) {
  const auto of_two = [](int support, double place_lead_nats) {
    Blob result = Searched(support, 57.25);
    result.Put("robots", Array::Texts({"one", "two"}));
    for (const char* robot : {"robot/0/", "robot/1/"}) {
      result.PutScalar<std::int64_t>(std::string(robot) + "shared_landmarks", 4);
      result.PutScalar<double>(std::string(robot) + "place_lead_nats", place_lead_nats);
    }
    return LandmarkMapVerdict(result);
  };
  EXPECT_EQ(of_two(7, 8).trust, Confidence::kFair);
  EXPECT_EQ(of_two(7, 8).why.find("of several robots right in 9 of 10 such simulations; found from 7 of 12"),
            0U)
      << of_two(7, 8).why;
  const Verdict square = of_two(7, 0.5);
  EXPECT_EQ(square.trust, Confidence::kLow);
  EXPECT_NE(square.why.find("where two is in the map of the others is uncertain: 4 landmarks in common"),
            std::string::npos)
      << square.why;
  EXPECT_EQ(of_two(1, 8).trust, Confidence::kLow);
}

// Contact detections unlike those of which rates are known: that two maps are as good as each other, or that
// most landmarks were seen once and passed again, tells all the same.
TEST(LandmarkMapVerdict, OfContactsUnlikeThoseMeasuredWhatIsDoubtedIsLow) {
  const auto unlike = [](int support, double lead_nats, const std::vector<std::int32_t>& seen) {
    Blob result = Searched(support, lead_nats);
    result.Put("search/unlike", Array::Texts({"travelled_m is 133, not 316 to 362"}));
    result.Put("robots", Array::Texts({"robot"}));
    result.PutVector("robot/0/observations/map_landmark", seen);
    result.PutVector<double>("map/landmark_x_m", {0, 1, 2, 3});
    result.PutVector<std::int64_t>("map/landmark_passes", {2, 2, 2, 2});
    return LandmarkMapVerdict(result);
  };
  const std::vector<std::int32_t> often = {0, 0, 1, 1, 2, 2, 3, 3}, once = {0, 0, 1, 1, 2, 3};
  EXPECT_EQ(unlike(10, 57.25, often).trust, Confidence::kNone);
  EXPECT_EQ(unlike(10, 1.5, often).trust, Confidence::kLow);
  EXPECT_EQ(unlike(1, 57.25, often).trust, Confidence::kLow);
  const Verdict doubted = unlike(10, 57.25, once);
  EXPECT_EQ(doubted.trust, Confidence::kLow);
  EXPECT_NE(doubted.why.find("not measured (travelled_m is 133"), std::string::npos) << doubted.why;
  EXPECT_NE(doubted.why.find("2 of them were passed again and not observed"), std::string::npos)
      << doubted.why;
}

TEST(LandmarkMapVerdict, IsHighWhereManyStartsFoundTheMapAndItIsFarAhead) {
  EXPECT_EQ(TextOf(Searched(3, 57.25)),
            "high: right in 99 of 100 such simulations, which have no false observations; found from 3 of 12 "
            "starts, "
            "57.2 nats ahead of the next different map");
  EXPECT_EQ(TextOf(Searched(7, 4.5)),
            "fair: right in 9 of 10 such simulations, which have no false observations; found from 7 of 12 "
            "starts, 4.5 nats ahead of the next "
            "different map");
  EXPECT_EQ(TextOf(Searched(1, 102.0)),
            "low: right in 3 of 10 such simulations, which have no false observations; found from 1 of 12 "
            "starts, 102.0 nats ahead of the next "
            "different map");
}

TEST(LandmarkMapVerdict, IsNeverHighWhereALandmarkWasMovedAndNamesIt) {
  Blob result = Searched(3, 57.25);
  result.Put("landmarks", Array::Texts({"door", "bin"}));
  result.PutVector("moved/landmark", std::vector<std::int32_t>{1});
  result.PutVector("moved/until_s", std::vector<double>{298.25});
  result.PutVector("moved/from_s", std::vector<double>{310});
  result.PutVector("moved/left_out", std::vector<std::int64_t>{22});
  result.PutVector("moved/later_left_out", std::vector<std::uint8_t>{1});
  const std::string text = TextOf(result);
  EXPECT_TRUE(text.starts_with("fair: ")) << text;
  EXPECT_TRUE(text.ends_with(
      "; landmark 'bin' was moved between 298.2 and 310.0 s: the 22 observations after that are left out; "
      "give it another name from 310.0 s on, and it is mapped in both places"))
      << text;
}

TEST(ReadConfidence, NeedsBothStartsThatAgreeAndALead) {
  EXPECT_EQ(ReadConfidence(Searched(3, 10.0)), Confidence::kHigh);
  EXPECT_EQ(ReadConfidence(Searched(3, 9.9)), Confidence::kFair);
  EXPECT_EQ(ReadConfidence(Searched(2, 99.0)), Confidence::kFair);
  EXPECT_EQ(ReadConfidence(Searched(2, 3.0)), Confidence::kFair);
  EXPECT_EQ(ReadConfidence(Searched(9, 2.9)), Confidence::kLow);
  EXPECT_EQ(ReadConfidence(Searched(1, 99.0)), Confidence::kLow);
}

TEST(LandmarkMapVerdict, StartsThatAgreeAndASingleStart) {
  EXPECT_EQ(TextOf(Searched(12, 1.0).Without("search/lead_nats")),
            "high: right in 99 of 100 such simulations, which have no false observations; found from 12 of "
            "12 starts, no other map was found");
  Blob once;
  once.PutScalar<std::int32_t>("search/support", 1);
  once.PutScalar<std::int32_t>("search/starts", 1);
  EXPECT_EQ(TextOf(once), "not known: EM started once, no other map to compare with");
  once.Put("search/why", Array::Text("as many as were asked for"));
  EXPECT_EQ(TextOf(once),
            "not known: EM started once, no other map to compare with (as many as were asked for)");
  EXPECT_EQ(TextOf(Blob()), "not known: there was no search");
}

TEST(LandmarkMapVerdict, WhereNothingIsKnownItSaysWhyAndWhatToDo) {
  Blob named;
  named.PutVector<std::int32_t>("map/landmark_identity", {0, 1});
  EXPECT_EQ(TextOf(named), "not known: there was no search");
  named.PutScalar<std::uint8_t>("refinement/done", 1);
  EXPECT_EQ(
      TextOf(named),
      "not known: there was no search, as observations name their landmarks; nor have contact detections "
      "a range or bearing whose errors would tell: compare the map with landmarks or poses that you know "
      "(cairn import csv --truth-landmarks, --truth-poses; cairn evaluate)");
  named.PutScalar<std::uint8_t>("refinement/done", 0);
  named.Put("refinement/reason", Array::Text("not tried: the map was given"));
  EXPECT_EQ(TextOf(named),
            "not known: there was no search, nor a refinement whose residuals would tell (not tried: the map "
            "was given)");
}

TEST(LandmarkMapVerdict, AFileThatHoldsSomethingElseStatesNone) {
  Blob result;
  result.Put("search/support", Array::Text("three"));
  EXPECT_EQ(ReadConfidence(result), Confidence::kNone);
  result.PutVector<double>("search/support", {3.0, 4.0});
  EXPECT_EQ(ReadConfidence(result), Confidence::kNone);
}

TEST(LandmarkMapVerdict, SaysWhatItsLandmarksDoNotExplain) {
  Blob result = Searched(5, 20);
  result.PutVector<std::int32_t>("robot/0/observations/map_landmark", {0, -1, 1, -1, -1});
  result.Put("robots", Array::Texts({"robot"}));
  EXPECT_NE(TextOf(result).find("; 3 of 5 observations are of none of its landmarks"), std::string::npos)
      << TextOf(result);
  result.PutScalar<std::int64_t>("until_observations", 3);  // the others were never looked at
  EXPECT_NE(TextOf(result).find("; 1 of 3 observations is of none of its landmarks"), std::string::npos)
      << TextOf(result);
}

TEST(LandmarkMapVerdict, NamesThatWereSeenAndAreNotInTheMapMakeItFair) {
  Blob result = Searched(7, 164.8);
  result.Put("landmarks", Array::Texts({"door", "rosa", "sofa"}));
  result.PutVector<std::int32_t>("missing_landmarks", {0, 2});
  EXPECT_EQ(LandmarkMapVerdict(result).trust, Confidence::kFair);
  EXPECT_NE(TextOf(result).find("; 2 landmarks were seen and are not in it: 'door', 'sofa'"),
            std::string::npos)
      << TextOf(result);
  EXPECT_EQ(TextOf(result).find("come first"), std::string::npos);
}

TEST(NotRefined, SaysWhyAndWhetherItWasRefused) {
  Blob result;
  EXPECT_EQ(NotRefined(result), "") << "older files do not say";
  result.Put("refinement/reason", Array::Text("refused: the least squares has no solution"));
  EXPECT_EQ(NotRefined(result), "refused: the least squares has no solution");
  EXPECT_TRUE(RefinementRefused(result));
  result.Put("refinement/reason", Array::Text("not tried: refine=false"));
  EXPECT_EQ(NotRefined(result), "not tried: refine=false");
  EXPECT_FALSE(RefinementRefused(result));
  result.Put("refinement/reason", Array::Text(""));
  EXPECT_EQ(NotRefined(result), "");
  EXPECT_FALSE(RefinementRefused(result));
  result.PutVector<double>("refinement/reason", {1.0});
  EXPECT_EQ(NotRefined(result), "") << "a file may hold anything";
}

TEST(LandmarkMapVerdict, AMapAlongOdometryIsLow) {
  Blob map = Searched(12, 57.25);
  map.PutScalar<std::uint8_t>("refinement/along_odometry", 1);
  EXPECT_TRUE(TextOf(map).starts_with(
      "low: no map that the search found explains the observations; this one lies along odometry"))
      << TextOf(map);
}

}  // namespace
}  // namespace cairn::datasets
