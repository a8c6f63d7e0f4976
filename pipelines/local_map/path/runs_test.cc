#include "pipelines/local_map/path/runs.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cairn::local_map {
namespace {

// Ahead 0.1 m each fifth of a second, with one control that is another; scanned at each control's end.
Blob Log(int controls, int odd, double odd_turn, double odd_forward, double pause_s = 0) {
  std::vector<double> time, turn, forward, range;
  double now = 0;
  for (int k = 0; k < controls; ++k) {
    now += 0.2 + (k == odd ? pause_s : 0);
    time.push_back(now);
    turn.push_back(k == odd ? odd_turn : 0);
    forward.push_back(k == odd ? odd_forward : 0.1);
    range.insert(range.end(), {1.0, 2.0});
  }
  Blob log;
  log.Put("robots", Array::Texts({"ann"}));
  log.PutVector("robot/0/odometry/time_s", time);
  log.PutVector("robot/0/odometry/turn_rad", turn);
  log.PutVector("robot/0/odometry/forward_m", forward);
  for (const char* kind : {"sonar/", "laser/"}) {
    const std::string sensor = std::string("robot/0/") + kind;
    std::vector<double> at = time;
    if (sensor == "robot/0/laser/")
      for (double& t : at) t += 0.005;  // read a moment later
    at.back() = time.back();
    log.PutVector(sensor + "time_s", at);
    log.Put(sensor + "range_m", Array::Of<double>({controls, 2}, range));
    log.PutVector<double>(sensor + "beam_x_m", {0, 0});
    log.PutVector<double>(sensor + "beam_y_m", {0, 0});
    log.PutVector<double>(sensor + "beam_heading_rad", {0, 1});
    log.PutScalar(sensor + "opening_rad", 0.0);
    log.PutScalar(sensor + "max_range_m", 8.0);
  }
  return log;
}

RobotRuns RunsOfLog(const Blob& log) {
  const RunOptions options;
  const DeadReckoning reckoning = ReckonAll(log, options);
  cairn::GridOptions reading;
  reading.skip_unposed = true;
  return CutRuns(ReadRangeScans(log, &reckoning.poses, reading), reckoning, options)[0];
}

TEST(Runs, ReadingsOfAMomentAreOneScan) {
  const RobotRuns runs = RunsOfLog(Log(20, -1, 0, 0));
  ASSERT_EQ(runs.sensors.size(), 2U);
  EXPECT_EQ(runs.scans.size(), 20U);
  EXPECT_TRUE(runs.cuts.empty());
  for (const std::int64_t row_of_log : runs.row_of_log) EXPECT_GE(row_of_log, 0);
  EXPECT_NEAR(runs.scans.back().pose.x_m, 2.0, 1e-9);
}

TEST(Runs, AreCutWhereOdometryJumpsAndTheJumpIsTakenOut) {
  const RobotRuns runs = RunsOfLog(Log(20, 10, 0, 5));
  ASSERT_EQ(runs.cuts.size(), 1U);
  EXPECT_EQ(runs.cuts[0].why, "jump");
  EXPECT_NEAR(runs.cuts[0].time_s, 2.0, 0.01);
  EXPECT_EQ(runs.scans[9].run, 0);
  EXPECT_EQ(runs.scans[10].run, 1);
  EXPECT_TRUE(runs.scans[10].jumped);
  EXPECT_NEAR(runs.scans.back().pose.x_m, 1.9, 1e-9);
}

TEST(Runs, AJumpOfTheHeadingLeavesTheWayAfterItOnTheHeadingBefore) {
  const RobotRuns runs = RunsOfLog(Log(20, 10, 2.5, 0.1));
  ASSERT_EQ(runs.cuts.size(), 1U);
  EXPECT_NEAR(runs.scans.back().pose.x_m, 1.9, 1e-9);
  EXPECT_NEAR(runs.scans.back().pose.y_m, 0, 1e-9);
  EXPECT_NEAR(runs.scans.back().pose.heading_rad, 0, 1e-9);
}

TEST(Runs, AWayBackwardsIsNoJump) {
  Blob log = Log(20, -1, 0, 0);  // that control 11 faces about for its way, and control 12 faces back
  const auto read = [&](const char* name) {
    const auto values = log.Get<double>(std::string("robot/0/odometry/") + name);
    return std::vector<double>(values.begin(), values.end());
  };
  std::vector<double> time = read("time_s"), turn = read("turn_rad"), forward = read("forward_m");
  time[12] = time[11];
  turn[11] = M_PI;
  turn[12] = -M_PI;
  forward[12] = 0;
  log.PutVector("robot/0/odometry/time_s", time);
  log.PutVector("robot/0/odometry/turn_rad", turn);
  log.PutVector("robot/0/odometry/forward_m", forward);
  const RobotRuns runs = RunsOfLog(log);
  EXPECT_TRUE(runs.cuts.empty());
  EXPECT_NEAR(runs.scans.back().pose.x_m, 1.7, 1e-9);
}

TEST(Runs, AScanAmidAControlHasTurnedAPartOfItsTurn) {
  Blob log = Log(5, -1, 0, 0);
  log.PutVector<double>("robot/0/odometry/time_s", {0, 1});
  log.PutVector<double>("robot/0/odometry/turn_rad", {0, 0.6});
  log.PutVector<double>("robot/0/odometry/forward_m", {0, 0.4});
  const std::vector<double> times{0.0, 0.02, 0.25, 0.5, 1.0};
  log.PutVector("robot/0/sonar/time_s", times);
  log.PutVector("robot/0/laser/time_s", times);
  const RobotRuns runs = RunsOfLog(log);
  ASSERT_EQ(runs.scans.size(), times.size());
  for (std::size_t s = 0; s < times.size(); ++s) {
    EXPECT_NEAR(runs.scans[s].pose.heading_rad, 0.6 * times[s], 1e-9);
    EXPECT_NEAR(runs.scans[s].pose.x_m, std::cos(0.6) * 0.4 * times[s], 1e-9);
    EXPECT_EQ(runs.scans[s].unsure, s == 2 || s == 3) << s;
  }
}

TEST(Runs, AreCutAtGapsWhichAreNoJumps) {
  const RobotRuns runs = RunsOfLog(Log(20, 10, 0, 0.1, 100));
  ASSERT_EQ(runs.cuts.size(), 1U);
  EXPECT_EQ(runs.cuts[0].why, "gap");
  EXPECT_FALSE(runs.scans[10].jumped);
  EXPECT_NEAR(runs.scans.back().pose.x_m, 2.0, 1e-9);
}

TEST(Runs, ALogWithoutOdometryGoesByItsPoses) {
  Blob log = Log(5, -1, 0, 0).Without("robot/0/odometry/");
  log.PutVector<double>("robot/0/poses/time_s", {0, 0.5, 1.0});
  log.PutVector<double>("robot/0/poses/x_m", {3, 3, 3});
  log.PutVector<double>("robot/0/poses/y_m", {0, 0.2, 0.4});
  log.PutVector<double>("robot/0/poses/heading_rad", {3.1, -3.1, 3.1});
  const RobotRuns runs = RunsOfLog(log);
  ASSERT_FALSE(runs.scans.empty());
  EXPECT_NEAR(runs.scans.back().pose.y_m, 0.4, 1e-9);
  EXPECT_NEAR(runs.scans.back().path_m, 0.4, 1e-9);
  EXPECT_THROW(ReckonAll(Log(5, -1, 0, 0).Without("robot/0/odometry/"), {}), InputError);
}

TEST(Runs, RowsAreThoseScans) {
  const RobotRuns runs = RunsOfLog(Log(20, 10, 0, 5));
  const std::vector<Scan> back = RowsIn<Scan>(RowsOf(runs));
  ASSERT_EQ(back.size(), runs.scans.size());
  for (std::size_t s = 0; s < back.size(); ++s) {
    EXPECT_EQ(back[s].pose.x_m, runs.scans[s].pose.x_m);
    EXPECT_EQ(back[s].run, runs.scans[s].run);
    EXPECT_EQ(back[s].jumped, runs.scans[s].jumped);
  }
}

}  // namespace
}  // namespace cairn::local_map
