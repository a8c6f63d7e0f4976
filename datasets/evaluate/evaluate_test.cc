#include "datasets/evaluate/evaluate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "datasets/evaluate/testing/perfect_result.h"
#include "datasets/simulate/loop.h"
#include "datasets/testing.h"
#include "schema/rng.h"

namespace cairn::datasets {
namespace {

std::vector<double> Column(const Blob& blob, const std::string& name) {
  const auto values = blob.Get<double>(name);
  return {values.begin(), values.end()};
}

// Four landmarks in a square of 10 m, observed one after the other at 0, 1, 2, 3 s by robot 'a', and landmark
// 0 again at 4 s; a fifth one that nobody observed; a pose each second.
Blob SquareLog() {
  Blob log;
  log.Put("robots", Array::Texts({"a"}));
  log.Put("landmarks", Array::Texts({}));
  log.PutVector("robot/0/observations/time_s", std::vector<double>{0, 1, 2, 3, 4});
  log.PutVector("robot/0/observations/landmark", std::vector<std::int32_t>(5, -1));
  log.PutVector("truth/robot/0/observations/landmark", std::vector<std::int32_t>{0, 1, 2, 3, 0});
  log.PutVector("truth/robot/0/poses/time_s", std::vector<double>{0, 1, 2, 3, 4});
  log.PutVector("truth/robot/0/poses/x_m", std::vector<double>{0, 10, 10, 0, 0});
  log.PutVector("truth/robot/0/poses/y_m", std::vector<double>{0, 0, 10, 10, 0});
  log.PutVector("truth/robot/0/poses/heading_rad", std::vector<double>{0, 0, 1, 2, 3});
  log.Put("truth/landmarks/name", Array::Texts({"l0", "l1", "l2", "l3", "l4"}));
  log.PutVector("truth/landmarks/x_m", std::vector<double>{0, 10, 10, 0, 500});
  log.PutVector("truth/landmarks/y_m", std::vector<double>{0, 0, 10, 10, 500});
  return log;
}

Blob Moved(Blob result, const Similarity& motion, int robots) {
  const auto move = [&](const std::string& x_name, const std::string& y_name) {
    std::vector<double> x = Column(result, x_name), y = Column(result, y_name);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Point at = motion(Point{x[i], y[i]});
      x[i] = at.x_m;
      y[i] = at.y_m;
    }
    result.PutVector(x_name, x);
    result.PutVector(y_name, y);
  };
  move("map/landmark_x_m", "map/landmark_y_m");
  for (int r = 0; r < robots; ++r) {
    const std::string poses = "robot/" + std::to_string(r) + "/poses/mode_";
    move(poses + "x_m", poses + "y_m");
    std::vector<double> heading = Column(result, poses + "heading_rad");
    for (double& h : heading) h = WrapAngle(h + motion.angle_rad);
    result.PutVector(poses + "heading_rad", heading);
  }
  return result;
}

TEST(Evaluate, AResultOfAnotherLogIsRefusedByItsHashTruthAside) {
  const Blob log = SimulateLoop({.seed = 3});
  Blob result = PerfectLandmarkMap(log);
  result.Put("log_hash", Array::Text(log.Without("truth/").ContentHash().Hex()));
  EXPECT_NO_THROW(Evaluate(result, log));
  Blob more_truth = log;
  std::vector<double> x = Column(log, "truth/landmarks/x_m");
  x[0] += 1.0;
  more_truth.PutVector("truth/landmarks/x_m", x);
  EXPECT_NO_THROW(Evaluate(result, more_truth));
  Blob other = log;  // as many robots, rows and the same times
  std::vector<double> turn = Column(log, "robot/0/odometry/turn_rad");
  turn[7] += 1e-9;
  other.PutVector("robot/0/odometry/turn_rad", turn);
  try {
    Evaluate(result, other);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("made from another log"), std::string::npos) << e.what();
  }
}

TEST(Evaluate, TruthItselfIsPerfect) {
  for (const std::string difficulty : {"paper", "base", "extreme"}) {
    const Blob log = SimulateLoop({.difficulty = difficulty, .robots = 2, .seed = 3});
    const Evaluation e = Evaluate(PerfectLandmarkMap(log), log);
    ASSERT_TRUE(e.landmarks);
    EXPECT_GT(e.landmarks->found, 10);
    EXPECT_EQ(e.landmarks->missed, 0);
    EXPECT_EQ(e.landmarks->spurious, 0);
    EXPECT_LT(e.landmarks->gospa_m, 1e-9);
    EXPECT_LT(*e.landmarks->rmse_m, 1e-9);
    EXPECT_LT(*e.landmarks->rmse_similarity_m, 1e-9);
    EXPECT_LT(*e.trajectory_rmse_m, 1e-9);
    EXPECT_EQ(e.robots.size(), 2U);
    EXPECT_EQ(e.robots[0].poses, log.at("truth/robot/0/poses/time_s").size());
    EXPECT_EQ(e.topology_correct, true);
    EXPECT_EQ(e.aligned_on, "poses");
    EXPECT_EQ(e.iterations, 1);
    EXPECT_FALSE(e.seconds);
  }
}

TEST(Evaluate, OnlyObservedLandmarksCount) {
  const Evaluation e = Evaluate(PerfectLandmarkMap(SquareLog()), SquareLog());
  EXPECT_EQ(e.landmarks->found, 4);
  EXPECT_EQ(e.landmarks->missed, 0);
}

// Landmark 0 is 1 m off, landmark 1 is 5 m off (missed and spurious), an extra one lies at (50, 50).
TEST(Evaluate, CountsAndErrorsByHand) {
  Blob result = PerfectLandmarkMap(SquareLog());
  result.PutVector("map/landmark_x_m", std::vector<double>{0, 15, 10, 0, 50});
  result.PutVector("map/landmark_y_m", std::vector<double>{1, 0, 10, 10, 50});
  result.PutVector("map/landmark_identity", std::vector<std::int32_t>(5, -1));
  result.PutScalar("provenance/seconds_s", 12.5);
  const Evaluation e = Evaluate(result, SquareLog());
  EXPECT_EQ(e.landmarks->found, 3);
  EXPECT_EQ(e.landmarks->missed, 1);
  EXPECT_EQ(e.landmarks->spurious, 2);
  EXPECT_EQ(e.landmarks->within_3m, 3);
  EXPECT_NEAR(*e.landmarks->rmse_m, std::sqrt(1.0 / 3), 1e-12);
  EXPECT_NEAR(e.landmarks->gospa_m, std::sqrt(1 + 3 * 4.5), 1e-12);
  EXPECT_EQ(e.topology_correct, false) << "the fifth landmark is extra";
  EXPECT_EQ(e.seconds, 12.5);
  EXPECT_EQ(e.pairs, (std::vector<std::pair<std::int64_t, std::int64_t>>{{0, 0}, {2, 2}, {3, 3}}));
}

// The last of five poses is (3, 4) m off; the alignment takes a share of that.
TEST(Evaluate, TrajectoryErrorIsThatOfTheMostLikelyPoses) {
  const Blob log = SquareLog();
  Blob result = PerfectLandmarkMap(log);
  result.PutVector("robot/0/poses/mode_x_m", std::vector<double>{0, 10, 10, 0, 3});
  result.PutVector("robot/0/poses/mode_y_m", std::vector<double>{0, 0, 10, 10, 4});
  const std::vector<PointPair> pairs = {
      {{0, 0}, {0, 0}}, {{10, 0}, {10, 0}}, {{10, 10}, {10, 10}}, {{0, 10}, {0, 10}}, {{3, 4}, {0, 0}}};
  const Evaluation e = Evaluate(result, log);
  EXPECT_NEAR(*e.trajectory_rmse_m, RmseM(pairs, FitRigid(pairs)), 1e-12);
  EXPECT_GT(*e.trajectory_rmse_m, 1);
  EXPECT_LT(*e.trajectory_rmse_m, std::sqrt(25.0 / 5));
}

TEST(Evaluate, TheWorstRobotCountsAndAllShareOneAlignment) {
  const Blob log = SimulateLoop({.difficulty = "paper", .robots = 2, .seed = 5});
  Blob result = PerfectLandmarkMap(log);
  std::vector<double> x = Column(result, "robot/1/poses/mode_x_m");
  for (double& value : x) value += 4;
  result.PutVector("robot/1/poses/mode_x_m", x);
  const Evaluation e = Evaluate(result, log);
  ASSERT_TRUE(e.robots[0].rmse_m && e.robots[1].rmse_m);
  EXPECT_EQ(*e.trajectory_rmse_m, std::max(*e.robots[0].rmse_m, *e.robots[1].rmse_m));
  EXPECT_GT(*e.robots[0].rmse_m, 1);  // an own alignment of each robot would make both vanish
  EXPECT_GT(*e.robots[1].rmse_m, 1);
}

TEST(Evaluate, ARigidMotionOfTheResultChangesNothing) {
  const Blob log = SimulateLoop({.difficulty = "base", .robots = 2, .seed = 8});
  Rng rng(1);
  Blob result = PerfectLandmarkMap(log);
  for (const std::string name : {"map/landmark_x_m", "robot/0/poses/mode_x_m", "robot/1/poses/mode_y_m"}) {
    std::vector<double> values = Column(result, name);
    for (double& value : values) value += rng.Normal();
    result.PutVector(name, values);
  }
  const Evaluation e = Evaluate(result, log);
  EXPECT_GT(*e.landmarks->rmse_m, 0.3);
  for (const Similarity& motion : {Similarity{1, 0, 1000, -200}, Similarity{1, 2.5, -30, 12}}) {
    const Evaluation moved = Evaluate(Moved(result, motion, 2), log);
    EXPECT_EQ(moved.pairs, e.pairs);
    EXPECT_NEAR(*moved.landmarks->rmse_m, *e.landmarks->rmse_m, 1e-9);
    EXPECT_NEAR(*moved.landmarks->rmse_similarity_m, *e.landmarks->rmse_similarity_m, 1e-9);
    EXPECT_NEAR(moved.landmarks->gospa_m, e.landmarks->gospa_m, 1e-9);
    EXPECT_NEAR(*moved.robots[1].rmse_m, *e.robots[1].rmse_m, 1e-9);
    EXPECT_NEAR(*moved.robots[1].heading_rmse_rad, *e.robots[1].heading_rmse_rad, 1e-9);
    EXPECT_EQ(moved.topology_correct, e.topology_correct);
  }
}

TEST(Evaluate, OnlyTheAlignmentWithAScaleForgivesAScale) {
  const Blob log = SimulateLoop({.difficulty = "base", .robots = 1, .seed = 9});
  const Evaluation e = Evaluate(Moved(PerfectLandmarkMap(log), {1.03, 1, 5, 5}, 1), log);
  EXPECT_GT(*e.landmarks->rmse_m, 0.3);
  EXPECT_LT(*e.landmarks->rmse_similarity_m, 1e-9);
  EXPECT_NEAR(e.scale, 1 / 1.03, 1e-12);
}

TEST(Evaluate, WithoutTruePosesAlignsOnTheLandmarks) {
  const Blob log = SimulateLoop({.difficulty = "base", .robots = 1, .seed = 10});
  const Blob result = Moved(PerfectLandmarkMap(log), {1, -2, 40, 9}, 1);
  const Blob blind = log.Without("truth/robot/0/poses/");
  const Blob anonymous = blind.Without("truth/robot/");  // no associations: nothing but two sets of points
  for (const Blob& truth : {blind, anonymous}) {
    const Evaluation e = Evaluate(result, truth);
    EXPECT_EQ(e.aligned_on, "landmarks");
    EXPECT_LT(*e.landmarks->rmse_m, 1e-6);
    EXPECT_FALSE(e.trajectory_rmse_m);
    EXPECT_FALSE(e.robots[0].rmse_m);
  }
  EXPECT_EQ(Evaluate(result, blind).topology_correct, true);
  EXPECT_FALSE(Evaluate(result, anonymous).topology_correct);
}

// A square looks the same four times; names say which way it lies, though the log has no true poses.
// A robot that turns on the spot: its places, 1 cm off here and there, would turn the map by any angle.
TEST(Evaluate, ARobotThatStaysInOnePlaceIsAlignedOnTheLandmarks) {
  Blob log = SquareLog();
  for (const std::string axis : {"x_m", "y_m"})
    log.PutVector("truth/robot/0/poses/" + axis, std::vector<double>(5, 3.0));
  Blob result = PerfectLandmarkMap(log);
  result.PutVector("robot/0/poses/mode_x_m", std::vector<double>{3.01, 2.99, 3, 3.01, 3});
  result.PutVector("robot/0/poses/mode_y_m", std::vector<double>{3, 3.01, 2.99, 3, 3.01});
  const Evaluation e = Evaluate(Moved(result, {1, 2, 40, 9}, 1), log);
  EXPECT_EQ(e.aligned_on, "landmarks");
  EXPECT_EQ(e.landmarks->found, 4);
  EXPECT_LT(*e.landmarks->rmse_m, 1e-9);
  EXPECT_LT(*e.trajectory_rmse_m, 0.02);
  EXPECT_LT(*e.robots[0].heading_rmse_rad, 1e-9);
}

TEST(Evaluate, KnownIdentitiesDecideTheAlignmentAndTheMatching) {
  Blob log = SquareLog().Without("truth/robot/0/poses/");
  log.Put("landmarks", Array::Texts({"l3", "l2", "l1", "l0"}));
  Blob result = PerfectLandmarkMap(log);
  result.PutVector("map/landmark_x_m", std::vector<double>{10, 10, 0, 0.4});
  result.PutVector("map/landmark_y_m", std::vector<double>{0, 10, 10, 0});
  const Evaluation e = Evaluate(result, log);
  EXPECT_EQ(e.landmarks->found, 4);
  EXPECT_LT(*e.landmarks->rmse_m, 0.4);
  EXPECT_NEAR(std::abs(e.alignment.angle_rad), 1.57, 0.1);
  EXPECT_EQ(e.pairs.front(), (std::pair<std::int64_t, std::int64_t>{0, 0}));
}

TEST(Evaluate, AFalseObservationMustBelongToNothing) {
  Blob log = SquareLog();
  log.PutVector("truth/robot/0/observations/landmark", std::vector<std::int32_t>{0, 1, 2, 3, -1});
  Blob result = PerfectLandmarkMap(log);
  EXPECT_EQ(Evaluate(result, log).topology_correct, true);
  result.PutVector("robot/0/observations/map_landmark", std::vector<std::int32_t>{0, 1, 2, 3, 0});
  EXPECT_EQ(Evaluate(result, log).topology_correct, false);
}

// Where many range-bearing observations share a frame the map is made of one image's: the others it does not
// look at.
TEST(Evaluate, ObservationsThatTheMapDoesNotUseAreUnusedNotWrong) {
  Blob log = SquareLog();
  log.PutVector("robot/0/observations/time_s", std::vector<double>{0, 1, 2, 3, 4, 4, 4, 4});
  log.PutVector("robot/0/observations/landmark", std::vector<std::int32_t>(8, -1));
  log.PutVector("truth/robot/0/observations/landmark", std::vector<std::int32_t>{0, 1, 2, 3, 0, 0, 1, 3});
  Blob result = PerfectLandmarkMap(log);
  result.PutVector("robot/0/observations/map_landmark", std::vector<std::int32_t>{0, 1, 2, 3, 0, -1, -1, -1});
  result.PutVector("robot/0/observations/probability", std::vector<double>{1, 1, 1, 1, 1, 0, 0, 0});
  Evaluation e = Evaluate(result, log);
  EXPECT_EQ(e.topology_correct, true);
  EXPECT_EQ(e.observations, 8);
  EXPECT_EQ(e.unused, 3);
  const auto json = nlohmann::json::parse(MakeScores(e).ToJson());
  EXPECT_EQ(json.at("topology").at("unused"), 3);
  EXPECT_EQ(json.at("topology").at("unused_share"), 0.375);
  EXPECT_NE(MakeScores(e).ToText().find("3 of 8 observations of landmarks (37.5%)"), std::string::npos)
      << MakeScores(e).ToText();
  // Looked at, and held to be false.
  result.PutVector("robot/0/observations/probability", std::vector<double>{1, 1, 1, 1, 1, 0.9, 0.9, 0.9});
  EXPECT_EQ(Evaluate(result, log).topology_correct, false);
}

TEST(Evaluate, TruePosesAloneScoreTheTrajectory) {
  const Blob log = SquareLog().Without("truth/landmarks/").Without("truth/robot/0/observations/");
  const Evaluation e = Evaluate(PerfectLandmarkMap(SquareLog()), log);
  EXPECT_FALSE(e.landmarks);
  EXPECT_FALSE(e.topology_correct);
  EXPECT_LT(*e.trajectory_rmse_m, 1e-9);
}

TEST(Evaluate, AnEmptyMapMissesEverything) {
  Blob result = PerfectLandmarkMap(SquareLog());
  for (const char* name : {"map/landmark_x_m", "map/landmark_y_m"})
    result.PutVector(name, std::vector<double>{});
  result.PutVector("map/landmark_identity", std::vector<std::int32_t>{});
  result.PutVector("robot/0/observations/map_landmark", std::vector<std::int32_t>(5, -1));
  const Evaluation e = Evaluate(result, SquareLog());
  EXPECT_EQ(e.landmarks->found, 0);
  EXPECT_EQ(e.landmarks->missed, 4);
  EXPECT_FALSE(e.landmarks->rmse_m);
  EXPECT_NEAR(e.landmarks->gospa_m, std::sqrt(4 * 4.5), 1e-12);
}

std::string MessageOf(const Blob& result, const Blob& log) {
  try {
    Evaluate(result, log);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Evaluate, SaysWhatIsWrongWithItsInput) {
  const Blob log = SquareLog(), result = PerfectLandmarkMap(log);
  EXPECT_NE(MessageOf(result, log.Without("truth/")).find("no truth"), std::string::npos);
  for (const std::string name : {"map/landmark_x_m", "history/log_likelihood", "robot/0/poses/mode_x_m",
                                 "robot/0/observations/map_landmark"}) {
    EXPECT_NE(MessageOf(result.Without(name), log).find(name), std::string::npos) << name;
  }
  Blob renamed = result;
  renamed.Put("robots", Array::Texts({"b"}));
  EXPECT_NE(MessageOf(renamed, log).find("('b') are not the log's ('a')"), std::string::npos);
  renamed.Put("robots", Array::Texts(std::vector<std::string>(2000, "b")));
  EXPECT_NE(MessageOf(renamed, log).find("('b', 'b', 'b', 'b', 'b' and 1995 more) are not the log's ('a')"),
            std::string::npos);
  Blob later = result;
  later.PutVector(
      "robot/0/poses/time_s",
      std::vector<double>(static_cast<std::size_t>(result.at("robot/0/poses/time_s").size()), 1e6));
  Blob driven = log;
  driven.PutVector("robot/0/odometry/time_s", std::vector<double>{0, 1, 2, 3, 4});
  EXPECT_EQ(MessageOf(result, driven), "");
  EXPECT_NE(MessageOf(later, driven).find("was it made from this log?"), std::string::npos);
}

TEST(EvaluationJson, HasEveryFieldAndNullWhereThereIsNoTruth) {
  const Blob log = SquareLog().Without("truth/robot/0/poses/");
  const auto json = nlohmann::json::parse(MakeScores(Evaluate(PerfectLandmarkMap(log), log)).ToJson());
  for (const char* name :
       {"found", "missed", "spurious", "within_3m", "rmse_m", "rmse_similarity_m", "gospa_m"}) {
    EXPECT_TRUE(json.at("landmarks").at(name).is_number()) << name;
  }
  EXPECT_TRUE(json.at("trajectory").at("rmse_m").is_null());
  EXPECT_TRUE(json.at("trajectory").at("robots").at(0).at("rmse_m").is_null());
  EXPECT_EQ(json.at("trajectory").at("robots").at(0).at("name"), "a");
  EXPECT_EQ(json.at("topology").at("correct"), true);
  EXPECT_EQ(json.at("topology").at("associations"), 5);
  EXPECT_EQ(json.at("topology").at("wrong"), 0);
  EXPECT_EQ(json.at("topology").at("observations"), 5);
  EXPECT_EQ(json.at("topology").at("unused"), 0);
  EXPECT_EQ(json.at("iterations"), 1);
  EXPECT_TRUE(json.at("seconds").is_null());
}

TEST(EvaluationText, SaysThatARefinementWasRefused) {
  const Blob log = SquareLog();
  Blob result = PerfectLandmarkMap(log);
  EXPECT_EQ(MakeScores(Evaluate(result, log)).ToText().find("refinement"), std::string::npos);
  result.Put("refinement/reason", Array::Text("refused: the least squares has no solution"));
  const Evaluation evaluation = Evaluate(result, log);
  EXPECT_NE(MakeScores(evaluation).ToText().find("refused: the least squares has no solution"),
            std::string::npos);
  EXPECT_EQ(nlohmann::json::parse(MakeScores(evaluation).ToJson()).at("refinement"),
            "refused: the least squares has no solution");
}

TEST(EvaluationText, SaysWhyThereIsNoErrorOfTheTrajectory) {
  const Blob result = PerfectLandmarkMap(SquareLog());
  Blob late = SquareLog();
  std::vector<double> time_s = Column(late, "truth/robot/0/poses/time_s");
  for (double& time : time_s) time += 3600;
  late.PutVector("truth/robot/0/poses/time_s", time_s);
  ExpectContains(
      MakeScores(Evaluate(result, late)).ToText(),
      "trajectory.rmse_m               unknown: no true pose is of a time at which the robot drove");
  const Blob blind = SquareLog().Without("truth/robot/0/poses/");
  ExpectContains(MakeScores(Evaluate(result, blind)).ToText(), "unknown: the truth has no poses");
}

TEST(EvaluationText, AsksWhetherTheTruthIsInAnotherUnit) {
  Blob result = PerfectLandmarkMap(SquareLog());
  result.Put("landmarks", Array::Texts({"l0", "l1", "l2", "l3"}));
  result.PutVector<std::int32_t>("map/landmark_identity", {0, 1, 2, 3});
  const Blob right = SquareLog();
  Blob log = right;
  for (const std::string name :
       {"landmarks/x_m", "landmarks/y_m", "robot/0/poses/x_m", "robot/0/poses/y_m"}) {
    std::vector<double> values = Column(log, "truth/" + name);
    for (double& value : values) value *= 1000;
    log.PutVector("truth/" + name, values);
  }
  const std::string text = MakeScores(Evaluate(result, log)).ToText();
  for (const std::string line : {"landmarks.frame                 ", "trajectory.frame                "})
    ExpectContains(text,
                   line +
                       "with the true positions divided by 1000 the map's would be 0.000 m off: are they "
                       "in millimetres?");
  EXPECT_EQ(MakeScores(Evaluate(result, right)).ToText().find("frame "), std::string::npos);
}

TEST(EvaluationText, SaysTheMainThings) {
  const std::string text = MakeScores(Evaluate(PerfectLandmarkMap(SquareLog()), SquareLog())).ToText();
  EXPECT_NE(text.find("4 of 4 observed"), std::string::npos);
  EXPECT_NE(text.find("topology.correct                yes"), std::string::npos);
}

TEST(EvaluationText, OfManyRobotsShowsSomeAndCountsTheOthers) {
  Evaluation many;
  for (int r = 0; r < 23; ++r)
    many.robots.push_back({.name = "r" + std::to_string(r), .rmse_m = 1, .heading_rmse_rad = 0, .poses = 1});
  const Scores scores = MakeScores(many);
  const std::string text = scores.ToText();
  ExpectContains(text, "  r19   1.000");
  EXPECT_EQ(text.find("  r20 "), std::string::npos) << text;
  ExpectContains(text, "trajectory.more_robots          3; --json has all\n");
  EXPECT_EQ(nlohmann::json::parse(scores.ToJson()).at("trajectory").at("robots").size(), 23U);
  many.robots.resize(20);
  EXPECT_EQ(MakeScores(many).ToText().find("more_robots"), std::string::npos);
}

TEST(Evaluate, APrefixIsNotAskedForWhatCameLater) {
  const Blob log = SquareLog();
  Blob result = PerfectLandmarkMap(log);  // as it would be after the third observation
  result.PutScalar<double>("until_s", 2.0);
  for (const char* axis : {"map/landmark_x_m", "map/landmark_y_m"}) {
    std::vector<double> points = Column(result, axis);
    points.resize(3);
    result.PutVector(axis, points);
  }
  result.PutVector<std::int32_t>("map/landmark_identity", {-1, -1, -1});
  result.PutVector<std::int32_t>("robot/0/observations/map_landmark", {0, 1, 2, -1, -1});
  const Evaluation e = Evaluate(result, log);
  EXPECT_TRUE(e.topology_correct.value());
  EXPECT_EQ(e.landmarks->found, 3);
  EXPECT_EQ(e.landmarks->missed, 0);
}

}  // namespace
}  // namespace cairn::datasets
