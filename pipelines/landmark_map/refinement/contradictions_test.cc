#include "pipelines/landmark_map/refinement/contradictions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pipelines/landmark_map/landmark_map.h"
#include "pipelines/landmark_map/testing.h"

namespace cairn::landmark_map {
namespace {

MapRules RulesOfContradictions() {
  MapRules rules;
  rules.types = 1;
  rules.observation_m = 0.3;
  return rules;
}

LayeredGrid CountsAt(double here, double there) {
  LayeredGrid counts;
  counts.layers.resize(2);
  counts.layers[0] = Layer(Box{0, 0, 21, 3});
  counts.layers[0].Row(1)[2] = here;
  counts.layers[0].Row(1)[18] = there;
  return counts;
}

Blob Named(const std::string& landmark) {
  Blob log;
  log.Put("landmarks", Array::Texts({landmark}));
  return log;
}

std::string ReasonOf(const Blob& log, const Options& options = {}) {
  try {
    RunInProcess(LandmarkMap(options), {{"log", std::make_shared<const Blob>(log)}});
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

void ExpectContains(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << text;
}

TEST(LandmarksInTwoPlaces, NamesTheLandmarkAndBothPlaces) {
  const auto found = LandmarksInTwoPlaces(CountsAt(10.0, 6.0), RulesOfContradictions(), Named("tower"));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].type, 0);
  EXPECT_DOUBLE_EQ(found[0].apart_m, 16.0);
  ExpectContains(found[0].reason, "'tower' stands in two places: 10 of its 16");
  ExpectContains(found[0].reason, "(2.00, 1.00)");
  ExpectContains(found[0].reason, "6 around (18.00, 1.00)");
  for (const char* cause : {"do bearings grow counter-clockwise", "are ranges in metres", "use one clock",
                            "was it moved", "were identities mixed up?"})
    ExpectContains(found[0].reason, cause);
}

TEST(LandmarksInTwoPlaces, HolesInTheOdometryAreNamedWithThem) {
  Blob log = Named("tower");
  std::vector<double> time, turn(40, 0.0), forward(40, 0.3);
  for (int i = 0; i < 40; ++i) time.push_back(i < 20 ? i : i + 60);
  log.Put("robots", Array::Texts({"anna"}));
  log.PutVector("robot/0/odometry/time_s", time);
  log.PutVector("robot/0/odometry/turn_rad", turn);
  log.PutVector("robot/0/odometry/forward_m", forward);
  log.PutVector("robot/0/observations/time_s", std::vector<double>{30, 40});
  const auto found = LandmarksInTwoPlaces(CountsAt(10.0, 6.0), RulesOfContradictions(), log);
  ASSERT_EQ(found.size(), 1U);
  ExpectContains(found[0].reason, "; robot 'anna': its odometry lacks 61 s from 19 s on");
}

TEST(LandmarksInTwoPlaces, SoAreBearingsThatAreAllTheSame) {
  Blob log = Named("tower");
  log.Put("robots", Array::Texts({"anna"}));
  log.PutVector("robot/0/observations/bearing_rad", std::vector<double>(20, 0.0));
  const auto found = LandmarksInTwoPlaces(CountsAt(10.0, 6.0), RulesOfContradictions(), log);
  ASSERT_EQ(found.size(), 1U);
  ExpectContains(found[0].reason, "; robot 'anna': all bearings of its observations of landmarks are 0 rad");
}

TEST(LandmarksInTwoPlaces, AFewMisreadNamesAreNone) {
  EXPECT_TRUE(LandmarksInTwoPlaces(CountsAt(100.0, 12.0), RulesOfContradictions(), Named("tower")).empty());
  EXPECT_TRUE(LandmarksInTwoPlaces(CountsAt(5.0, 3.0), RulesOfContradictions(), Named("tower")).empty());
}

TEST(StillInTwoPlaces, LeastSquaresFindsTheOneOrDoesNot) {
  const std::vector<InTwoPlaces> found{{1, 8.0, "two places", {}, {}}};
  std::vector<Landmark> landmarks(2);
  landmarks[0].type = 0;
  landmarks[1].type = 1;
  ModelFit fit;
  const Eigen::Vector2d far(9.0, 0.0), near(1.9, 0.0), further(2.1, 0.0);
  fit.off_m = {std::vector(16, far), std::vector(16, near)};
  std::fill_n(fit.off_m[1].begin(), 3, further);
  EXPECT_TRUE(StillInTwoPlaces({}, landmarks, nullptr).empty());
  EXPECT_TRUE(StillInTwoPlaces(found, landmarks, &fit).empty());
  fit.off_m[1][3] = further;
  EXPECT_EQ(StillInTwoPlaces(found, landmarks, &fit).size(), 1U);
  EXPECT_EQ(StillInTwoPlaces(found, landmarks, nullptr).size(), 1U);
  landmarks.pop_back();
  EXPECT_EQ(StillInTwoPlaces(found, landmarks, &fit).size(), 1U);
}

// Of twenty observations eight are false, and fall anywhere.
TEST(StillInTwoPlaces, FalseObservationsAreNoPlace) {
  const std::vector<InTwoPlaces> found{{0, 8.0, "two places", {}, {}}};
  std::vector<Landmark> landmarks(1);
  ModelFit fit;
  fit.off_m = {std::vector(20, Eigen::Vector2d(0.1, 0.0))};
  for (int k = 0; k < 8; ++k)
    fit.off_m[0][static_cast<std::size_t>(k)] = {6.0 * std::cos(k), 6.0 * std::sin(k)};
  EXPECT_TRUE(StillInTwoPlaces(found, landmarks, &fit).empty());
  for (int k = 0; k < 5; ++k) fit.off_m[0][static_cast<std::size_t>(k)] = {5.0, 5.0};
  EXPECT_EQ(StillInTwoPlaces(found, landmarks, &fit).size(), 1U);
}

// Of two robots that observed these landmarks, and whose maps cost the first one 100 nats.
std::string WhyTheyDisagree(std::int32_t first, std::int32_t second) {
  Blob log = Named("tower");
  log.Put("robots", Array::Texts({"one", "two"}));
  log.PutVector("robot/0/observations/landmark", std::vector<std::int32_t>{-1, first});
  log.PutVector("robot/1/observations/landmark", std::vector<std::int32_t>{-1, second});
  Blob history;
  history.PutVector("robots", std::vector<std::int64_t>{1, 2});
  history.PutVector("log_likelihood", std::vector<double>{100.0, 0.0});
  try {
    CheckRobotsAgree(RoundSum(Settings(), 2), history, 4.0, 10, log);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(CheckRobotsAgree, WhereNamesSayThatTheyMetTheSameTheyWereNotElsewhere) {
  const std::string named = WhyTheyDisagree(0, 0);
  ExpectContains(named, "the robots contradict each other");
  EXPECT_EQ(named.find("somewhere else"), std::string::npos) << named;
  for (const char* cause :
       {"'one' and 'two' have both seen 'tower'", "do bearings grow counter-clockwise",
        "are ranges in metres", "use one clock", "was it moved", "were identities mixed up?"})
    ExpectContains(named, cause);
  const std::string unnamed = WhyTheyDisagree(0, -1);
  ExpectContains(unnamed, "was one of them somewhere else?");
  for (const std::string& reason : {named, unnamed})
    for (const char* option : {"errors of the sensor or of odometry larger", "--contact-m", "--range-m",
                               "--heading-drift-rad-per-m"})
      ExpectContains(reason, option);
}

// Of a second robot whose ten observations are worth so much under the first one's map.
std::string WhyItFitsNowhere(double log_likelihood) {
  Blob of_robots = RoundSum(Settings(), 2).ToBlob();
  of_robots.PutVector("log_likelihood_of", std::vector<double>{0.0, log_likelihood});
  Perception perception;
  perception.likelihood = CountsAt(1.0, 1.0);
  perception.outside = {1.0, 1.0};
  std::vector<RobotSteps> steps(2);
  steps[1].observations.resize(10);
  Blob log = Named("tower");
  log.Put("robots", Array::Texts({"one", "two"}));
  try {
    CheckRobotsFitTheMap(RoundSum::FromBlob(Settings(), of_robots, 2), {perception, perception}, steps, log);
  } catch (const RobotsContradictError& error) {
    return error.what();
  }
  return "";
}

TEST(CheckRobotsFitTheMap, SaysWhetherItFitsWorseThanFalseOnesOrNotBetterByEnough) {
  ExpectContains(WhyItFitsNowhere(-54.0),
                 "its 10 observations are 54.0 nats less likely there than if every one were false; was it");
  ExpectContains(
      WhyItFitsNowhere(1.0),
      "its 10 observations are 1.0 nats likelier there than if every one were false, and more than "
      "2.5 would be where it belongs; was it");
  ExpectContains(WhyItFitsNowhere(1.0), "is its odometry in metres, as its ranges are (not in feet)?");
  EXPECT_EQ(WhyItFitsNowhere(2.6), "");
}

TEST(LandmarkMap, ARobotThatNeverMeetsTheOthersLandmarksIsRefused) {
  Blob log = SquareLog{.laps = 4, .side_m = 20.0, .ranged = true, .identified = true}.Make();
  Blob other = SquareLog{.laps = 4, .side_m = 20.0, .ranged = true, .identified = true, .seed = 2}.Make();
  const auto named = other.Get<std::int32_t>("robot/0/observations/landmark");
  std::vector<std::int32_t> renamed;
  for (const std::int32_t k : named) renamed.push_back(k + 4);
  other.PutVector("robot/0/observations/landmark", renamed);
  log.Put("landmarks", Array::Texts({"a", "b", "c", "d", "e", "f", "g", "h"}));
  log.Put("robots", Array::Texts({"one", "two"}));
  log.PutAll("robot/1/", other.Sub("robot/0/"));
  ExpectContains(ReasonOf(log), "robot 'two' has seen nothing that the first robot saw too");
}

// It may be turned about the one that both saw by any angle: to look for it everywhere takes all memory.
TEST(LandmarkMap, ARobotThatSharesOneLandmarkWithTheFirstIsRefusedAndOneThatSharesTwoIsNot) {
  const Blob one = SquareLog{.laps = 4, .ranged = true, .identified = true}.Make();
  const Blob two = SquareLog{.laps = 2, .ranged = true, .identified = true, .seed = 2}.Make();
  const auto named = two.Get<std::int32_t>("robot/0/observations/landmark");
  const Options coarse{.cell_m = 1.0, .heading_deg = 10.0};
  const auto sharing = [&](std::int32_t count) {
    Blob log = one;
    std::vector<std::int32_t> renamed;
    for (const std::int32_t k : named) renamed.push_back(k < count ? k : k + 4);
    log.Put("landmarks", Array::Texts({"a", "b", "c", "d", "e", "f", "g", "h"}));
    log.Put("robots", Array::Texts({"one", "two"}));
    log.PutAll("robot/1/", two.Sub("robot/0/"));
    log.PutVector("robot/1/observations/landmark", renamed);
    return log;
  };
  ExpectContains(
      ReasonOf(sharing(1), coarse),
      "robot 'two' has seen only one landmark that another robot saw too, 'a': about that it may be "
      "turned by any angle, so it cannot be placed; at least two must have the same names");
  EXPECT_EQ(ReasonOf(sharing(2), coarse), "");
}

TEST(LandmarkMap, OfARobotWithoutObservationsItSaysSoAndWhatToDo) {
  const Blob log = SquareLog{.laps = 4, .identified = true}.Make();
  for (const std::size_t idle : {0U, 1U}) {
    Blob both = log;
    both.Put("robots", Array::Texts({"one", "two"}));
    both.PutAll("robot/1/", log.Sub("robot/0/"));
    const std::string observations = "robot/" + std::to_string(idle) + "/observations/";
    for (const char* column : {"time_s", "range_m", "bearing_rad"})
      both.PutVector(observations + column, std::vector<double>{});
    both.PutVector(observations + "landmark", std::vector<std::int32_t>{});
    ExpectContains(ReasonOf(both), idle == 1
                                       ? "robot 'two' has no observations: it cannot be placed; leave its"
                                       : "the first robot has no observations");
  }
}

}  // namespace
}  // namespace cairn::landmark_map
