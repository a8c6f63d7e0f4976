#include "datasets/evaluate/local.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

namespace cairn::datasets {
namespace {

constexpr double kDegree_rad = std::numbers::pi / 180;

// Truth: ten metres along x at 1 m/s, from (5, 2), facing 0; odometry says that it went round a bend. The
// result has the same way from the origin, facing a quarter turn left, and one trace of all of it.
Blob Log() {
  Blob log;
  log.Put("robots", Array::Texts({"ann"}));
  std::vector<double> time, x, y, heading, turn, forward, walls;
  for (int i = 0; i <= 10; ++i) {
    time.push_back(i);
    x.push_back(5 + i);
    y.push_back(2);
    heading.push_back(0);
    turn.push_back(i == 0 ? 0 : 3 * kDegree_rad);
    forward.push_back(i == 0 ? 0 : 1);
    walls.push_back(0);
  }
  log.PutVector("truth/robot/0/poses/time_s", time);
  log.PutVector("truth/robot/0/poses/x_m", x);
  log.PutVector("truth/robot/0/poses/y_m", y);
  log.PutVector("truth/robot/0/poses/heading_rad", heading);
  log.PutVector("truth/robot/0/walls/time_s", time);
  log.PutVector("truth/robot/0/walls/angle_rad", walls);
  log.PutVector("robot/0/odometry/time_s", time);
  log.PutVector("robot/0/odometry/turn_rad", turn);
  log.PutVector("robot/0/odometry/forward_m", forward);
  return log;
}

Blob Result(const Blob& log) {
  Blob result;
  result.Put("robots", log.at("robots"));
  result.Put("log_hash", Array::Text(log.Without("truth/").ContentHash().Hex()));
  std::vector<double> time, x, y, heading, angle;
  std::vector<std::uint8_t> locked, other;
  for (int i = 0; i <= 10; ++i) {
    time.push_back(i);
    x.push_back(0);
    y.push_back(i);
    heading.push_back(std::numbers::pi / 2);
    angle.push_back(i < 2 ? std::nan("")
                          : (3 * i + 1) * kDegree_rad);  // odometry turns by 3 degrees a second
    locked.push_back(i >= 2 ? 1 : 0);
    other.push_back(0);
  }
  const std::string poses = "robot/0/poses/", walls = "robot/0/walls/";
  result.PutVector(poses + "time_s", time);
  result.PutVector(poses + "x_m", x);
  result.PutVector(poses + "y_m", y);
  result.PutVector(poses + "heading_rad", heading);
  result.PutVector(walls + "time_s", time);
  result.PutVector(walls + "angle_rad", angle);
  result.PutVector(walls + "locked", locked);
  result.PutVector(walls + "other_area", other);
  result.PutVector<std::int32_t>("traces/robot", {0});
  result.PutVector<double>("traces/first_s", {0});
  result.PutVector<double>("traces/last_s", {10});
  result.PutVector<double>("traces/x_m", {0});
  result.PutVector<double>("traces/y_m", {-1});
  result.PutVector<double>("traces/direction_rad", {std::numbers::pi / 2});
  // The robot is at z = 1 + time. Two loops of it to its own way, one a metre off, and one that is not used.
  result.PutVector<std::int32_t>("connections/from", {0, 0, 0, 0});
  result.PutVector<std::int32_t>("connections/to", {0, 0, 0, 0});
  result.PutVector<std::int32_t>("connections/kind", {2, 2, 2, 0});
  result.PutVector<double>("connections/from_z_m", {4.1, 8, 3, 0});
  result.PutVector<double>("connections/from_u_m", {0, 0, 0, 0});
  result.PutVector<double>("connections/to_s", {3, 6, 9, 1});
  result.PutVector<std::uint8_t>("connections/used", {1, 1, 0, 1});
  return result;
}

TEST(EvaluateLocal, APathThatIsRightHasNoErrorAndOdometryHas) {
  const Blob log = Log();
  const LocalEvaluation score = EvaluateLocal(Result(log), log);
  EXPECT_NEAR(score.path.rmse_m, 0, 1e-9);
  EXPECT_NEAR(score.heading_rmse_deg, 0, 1e-6);
  EXPECT_EQ(score.path.poses, 11);
  EXPECT_GT(score.odometry.rmse_m, 0.1);  // a bend of 30 degrees, laid over a straight line as well as can be
  EXPECT_LT(score.odometry.rmse_m, 0.5);
}

TEST(EvaluateLocal, AShiftedPoseCountsAsFarAsItIsOff) {
  const Blob log = Log();
  Blob result = Result(log);
  auto x = result.Get<double>("robot/0/poses/x_m");
  std::vector<double> moved(x.begin(), x.end());
  moved[5] = 1;
  result.PutVector("robot/0/poses/x_m", moved);
  const LocalEvaluation score = EvaluateLocal(result, log);
  EXPECT_NEAR(score.path.worst_m, 10.0 / 11, 1e-6);
  EXPECT_NEAR(score.path.mean_m, (10.0 / 11 + 10 * 1.0 / 11) / 11, 1e-6);
}

TEST(EvaluateLocal, WallsAreHeldAgainstTheFrameOfDeadReckoning) {
  const Blob log = Log();
  const LocalEvaluation score = EvaluateLocal(Result(log), log);
  ASSERT_TRUE(score.walls.has_value());
  EXPECT_NEAR(score.walls->error_deg, 1, 1e-6);
  EXPECT_EQ(score.walls->within_2_deg, 1);
  EXPECT_EQ(score.walls->first_lock_s, 2);
  EXPECT_EQ(score.walls->scans, 9);
  EXPECT_FALSE(score.walls->other_area_found.has_value());
}

TEST(EvaluateLocal, TurnedAreasAreToldAndLeftOutOfTheError) {
  Blob log = Log();
  std::vector<double> walls(11, 0);
  for (std::size_t i = 7; i < 11; ++i) walls[i] = 30 * kDegree_rad;
  log.PutVector("truth/robot/0/walls/angle_rad", walls);
  Blob result = Result(log);
  std::vector<std::uint8_t> other(11, 0);
  other[4] = other[8] = 1;
  result.PutVector("robot/0/walls/other_area", other);
  const LocalEvaluation score = EvaluateLocal(result, log);
  EXPECT_EQ(score.walls->scans, 4);  // 2, 3, 5, 6
  EXPECT_NEAR(*score.walls->other_area_found, 0.25, 1e-12);
  EXPECT_NEAR(*score.walls->other_area_false, 0.2, 1e-12);
}

TEST(EvaluateLocal, WhicheverWayTheTruthIsTurnedItsWallsScoreTheSame) {
  for (const double turned_rad : {1e-3, 0.02, 1.0, std::numbers::pi / 2, 3.0}) {
    Blob log = Log();
    std::vector<double> x, y, walls(11, turned_rad);
    for (int i = 0; i <= 10; ++i) {
      x.push_back((5 + i) * std::cos(turned_rad) - 2 * std::sin(turned_rad));
      y.push_back((5 + i) * std::sin(turned_rad) + 2 * std::cos(turned_rad));
    }
    for (std::size_t i = 7; i < 11; ++i) walls[i] += 30 * kDegree_rad;
    log.PutVector("truth/robot/0/poses/x_m", x);
    log.PutVector("truth/robot/0/poses/y_m", y);
    log.PutVector("truth/robot/0/poses/heading_rad", std::vector<double>(11, turned_rad));
    log.PutVector("truth/robot/0/walls/angle_rad", walls);
    const LocalEvaluation score = EvaluateLocal(Result(log), log);
    ASSERT_TRUE(score.walls.has_value()) << turned_rad;
    EXPECT_EQ(score.walls->scans, 5) << turned_rad;  // 2 to 6
    EXPECT_NEAR(score.walls->error_deg, 1, 1e-6) << turned_rad;
  }
}

TEST(EvaluateLocal, ALoopIsWrongWhereTheTruthHasTheRobotElsewhere) {
  const Blob log = Log();
  const LocalEvaluation score = EvaluateLocal(Result(log), log);
  EXPECT_EQ(score.loops.found, 2);
  EXPECT_EQ(score.loops.wrong, 1);
  EXPECT_EQ(score.loops.rejected, 1);
  EXPECT_EQ(score.loops.rejected_wrong, 1);
  EXPECT_NEAR(score.loops.mean_m, 0.1, 1e-9);
}

TEST(EvaluateLocal, PositionsAreScoredInTheirTracesFrames) {
  const Blob log = Log();
  Blob result = Result(log);
  EXPECT_FALSE(EvaluateLocal(result, log).traces.has_value());
  const std::string positions = "robot/0/positions/";
  result.PutVector<double>(positions + "time_s", {2, 4});
  result.PutVector<std::int32_t>(positions + "trace", {0, 0});
  result.PutVector<double>(positions + "z_m", {3, 5.3});
  result.PutVector<double>(positions + "u_m", {0, 0.4});
  result.PutVector<std::uint8_t>(positions + "corrected", {1, 0});
  const LocalEvaluation score = EvaluateLocal(result, log);
  ASSERT_TRUE(score.traces.has_value());
  EXPECT_NEAR(score.traces->mean_m, 0.25, 1e-9);
  EXPECT_NEAR(score.traces->worst_m, 0.5, 1e-9);
  EXPECT_NEAR(score.corrected, 0.5, 1e-12);
}

// The trace is recorded during the first two seconds, in which odometry turns by 3 degrees a metre; then the
// robot drives on, and odometry alone leaves the frame by the bend that it has made since.
TEST(EvaluateLocal, OdometryIsHeldAgainstTheFramesOfTracesToo) {
  const Blob log = Log();
  Blob result = Result(log);
  result.PutVector<double>("traces/last_s", {2});
  const std::string positions = "robot/0/positions/";
  result.PutVector<double>(positions + "time_s", {1, 10});
  result.PutVector<std::int32_t>(positions + "trace", {0, 0});
  result.PutVector<double>(positions + "z_m", {2, 11});
  result.PutVector<double>(positions + "u_m", {0, 0});
  result.PutVector<std::uint8_t>(positions + "corrected", {1, 1});
  const LocalEvaluation score = EvaluateLocal(result, log);
  EXPECT_NEAR(score.traces->mean_m, 0, 1e-9);
  // Odometry's headings were 0, 3 and 6 degrees: its frame is turned by -3. Control i goes on by 3 (i - 1)
  // degrees in it.
  double x = 0, y = 0;
  for (int i = 1; i <= 10; ++i) {
    x += std::cos((3 * i - 3) * kDegree_rad);
    y += std::sin((3 * i - 3) * kDegree_rad);
  }
  const double c = std::cos(3 * kDegree_rad), s = std::sin(3 * kDegree_rad);
  const double mean_x = (0 + 1 + (1 + c)) / 3, mean_y = s / 3;  // of the recorded way, in that frame
  const auto off = [&](double at_x, double at_y, double true_x) {
    return std::hypot(at_x - mean_x - (true_x - 1), at_y - mean_y);
  };
  EXPECT_NEAR(score.traces_odometry.mean_m, (off(1, 0, 1) + off(x, y, 10)) / 2, 1e-9);
  EXPECT_GT(score.traces_odometry.worst_m, 1);
}

TEST(EvaluateLocal, JsonHasTheNamesThatAreWrittenOf) {
  const Blob log = Log();
  const auto json = nlohmann::json::parse(MakeScores(EvaluateLocal(Result(log), log)).ToJson());
  for (const char* name : {"/trajectory/rmse_m", "/trajectory/odometry_rmse_m", "/trajectory/mean_m",
                           "/wall_orientation/error_deg", "/loops/found", "/loops/wrong"})
    EXPECT_TRUE(json.at(nlohmann::json::json_pointer(name)).is_number()) << name;
  EXPECT_TRUE(json["trajectory"]["in_trace_mean_m"].is_null());
  EXPECT_NEAR(json["loops"]["mean_m"].get<double>(), 0.1, 1e-9);
  LocalEvaluation none = EvaluateLocal(Result(log), log);
  none.loops = {};
  EXPECT_TRUE(nlohmann::json::parse(MakeScores(none).ToJson())["loops"]["mean_m"].is_null()) << "of none";
  const std::string text = MakeScores(EvaluateLocal(Result(log), log)).ToText();
  EXPECT_NE(text.find("loops.found                       2, 1 of them wrong\n"), std::string::npos) << text;
}

TEST(EvaluateLocal, RefusesWhatDoesNotFit) {
  const Blob log = Log();
  Blob other = Log();
  other.PutVector("robot/0/odometry/forward_m", std::vector<double>(11, 2));
  EXPECT_THROW(EvaluateLocal(Result(log), other), InputError);
  EXPECT_THROW(EvaluateLocal(Result(log), log.Without("truth/")), InputError);
  EXPECT_THROW(EvaluateLocal(log, log), InputError);
}

// The second robot's path is the first one's, in another frame.
TEST(EvaluateLocal, EachRobotsPathIsLaidOverItsOwnTruth) {
  Blob log = Log();
  Blob result = Result(log);
  for (Blob* blob : {&log, &result}) {
    const Blob::Fields fields = blob->fields();
    for (const auto& [name, array] : fields) {
      for (const std::string prefix : {"robot/0/", "truth/robot/0/"})
        if (name.starts_with(prefix))
          blob->Put(prefix.substr(0, prefix.size() - 2) + "1/" + name.substr(prefix.size()), array);
    }
    blob->Put("robots", Array::Texts({"a", "b"}));
  }
  std::vector<double> x, y, heading;
  for (int i = 0; i <= 10; ++i) {
    x.push_back(100 - i);
    y.push_back(7);
    heading.push_back(std::numbers::pi);
  }
  result.PutVector("robot/1/poses/x_m", x);
  result.PutVector("robot/1/poses/y_m", y);
  result.PutVector("robot/1/poses/heading_rad", heading);
  result.Put("log_hash", Array::Text(log.Without("truth/").ContentHash().Hex()));
  const LocalEvaluation evaluation = EvaluateLocal(result, log);
  EXPECT_NEAR(evaluation.path.rmse_m, 0, 1e-9);
  EXPECT_NEAR(evaluation.heading_rmse_deg, 0, 1e-6);
  ASSERT_EQ(evaluation.alignment.size(), 2U);
}

}  // namespace
}  // namespace cairn::datasets
