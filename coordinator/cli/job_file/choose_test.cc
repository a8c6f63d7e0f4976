#include "coordinator/cli/job_file/choose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "schema/error.h"
#include "schema/kinds/log.h"

namespace cairn::cli {
namespace {

using kinds::Log;

struct Of {
  std::size_t robots = 1;
  int observations = 0, scans = 0;
  std::string sensor = "laser";
  bool poses = false, odometry = true;
  double forward_m = 1;
  int at_once = 1;  // observations
};

Blob LogOf(const Of& of) {
  Log log;
  std::vector<std::string> names;
  for (std::size_t r = 0; r < of.robots; ++r) {
    names.push_back("robot " + std::to_string(r));
    Log::Robot robot;
    if (of.odometry)
      robot.odometry = {std::vector{0.0, 1.0}, std::vector{0.0, 0.0},
                        std::vector{of.forward_m, of.forward_m}};
    std::vector<double> times;
    for (int i = 0; i < of.observations; ++i) {
      const int at = i / of.at_once;
      times.push_back(0.1 * at);
    }
    robot.observations.time_s = times;
    robot.observations.landmark = std::vector<std::int32_t>(times.size(), -1);
    robot.observations.range_m = std::vector<double>(times.size(), 1.0);
    robot.observations.bearing_rad = std::vector<double>(times.size(), 0.0);
    if (of.poses) robot.poses.Set({0, 1}, {Pose{}, Pose{1, 0, 0}});
    if (of.scans > 0) {
      Log::RangeSensor sensor;
      sensor.sensor = of.sensor;
      std::vector<double> scan_times;
      for (int i = 0; i < of.scans; ++i) scan_times.push_back(0.01 * i);
      sensor.time_s = scan_times;
      sensor.range_m = Column<double>({of.scans, 2}, std::vector<double>(2 * scan_times.size(), 3.0));
      sensor.beam_x_m = sensor.beam_y_m = sensor.beam_heading_rad = std::vector{0.0, 0.0};
      sensor.opening_rad = 0.0;
      sensor.max_range_m = 10.0;
      robot.sensors.push_back(sensor);
    }
    log.robot.push_back(robot);
  }
  log.robots = names;
  return BlobOf(log);
}

// "landmarks landmark_map; grid forward_map of landmarks".
std::string Stages(const ChosenJob& chosen) {
  std::string text;
  for (const proto::Stage& stage : chosen.job.stages()) {
    text += (text.empty() ? "" : "; ") + stage.name() + " " + stage.pipeline();
    if (stage.inputs().contains("poses")) text += " of " + stage.inputs().at("poses");
  }
  return text;
}

TEST(ChooseJob, RunsWhatTheLogHoldsDataFor) {
  EXPECT_EQ(Stages(ChooseJob(LogOf({.observations = 3}))), "landmarks landmark_map");
  EXPECT_EQ(Stages(ChooseJob(LogOf({.scans = 5}))), "path local_map; grid forward_map of path");
  EXPECT_EQ(Stages(ChooseJob(LogOf({.observations = 3, .scans = 5}))),
            "landmarks landmark_map; path local_map; grid forward_map of path");
  EXPECT_EQ(Stages(ChooseJob(LogOf({.robots = 2, .observations = 3}))), "landmarks landmark_map");
}

// Two at once tell where the robot is: with them no way is left to the laser. What is shown is the way of the
// second control, over which there is an observation only where the last is at 1 s.
TEST(ChooseJob, AGridHasThePosesOfLandmarksThatAreSeenAllAlong) {
  const auto grid = [](Of of) {
    of.scans = 5;
    const std::string reason = ChooseJob(LogOf(of)).reasons.back();
    return reason.substr(reason.find("poses of "), reason.find(';') - reason.find("poses of "));
  };
  EXPECT_EQ(
      grid({.observations = 22, .forward_m = 9.5, .at_once = 2}),
      "poses of 'landmarks', for it is never more than 9.5 m between two landmarks at once and the next "
      "two");
  EXPECT_EQ(grid({.observations = 22, .forward_m = 11, .at_once = 2}),
            "poses of 'path', for there are 11 m without two landmarks at once");
  EXPECT_EQ(grid({.observations = 11, .forward_m = 9.5}),
            "poses of 'path', for there are 19 m without two landmarks at once");
}

// A laser shows walls where no landmark is; landmarks that a robot with sonar sees all along tell more.
TEST(ChooseJob, AGridHasThePosesOfTheStageThatSeesMore) {
  const auto grid = [](Of of) {
    const ChosenJob chosen = ChooseJob(LogOf(of));
    return chosen.job.stages().rbegin()->inputs().at("poses") +
           chosen.reasons.back().substr(chosen.reasons.back().rfind(';'));
  };
  const std::string path = "path; `poses: landmarks` in the job file takes the other stage's",
                    landmarks = "landmarks; `poses: path` in the job file takes the other stage's";
  EXPECT_EQ(grid({.observations = 3, .scans = 5}), path);
  EXPECT_EQ(grid({.observations = 3, .scans = 5, .sensor = "sonar"}), landmarks);
  // Observed until 0.2 s: over the second control none is.
  EXPECT_EQ(grid({.observations = 3, .scans = 5, .sensor = "sonar", .forward_m = 21}), path);
  EXPECT_EQ(grid({.observations = 11, .scans = 5, .sensor = "sonar", .forward_m = 11}), landmarks);
}

TEST(ChooseJob, TakesTheLogsOwnPosesWhereEveryRobotHasThem) {
  const ChosenJob chosen = ChooseJob(LogOf({.scans = 5, .poses = true}));
  EXPECT_EQ(Stages(chosen), "grid forward_map");
  EXPECT_EQ(chosen.reasons.front(), "path: the log has poses of its own, which are taken as they are");
  EXPECT_EQ(Stages(ChooseJob(LogOf({.observations = 3, .scans = 5, .poses = true}))),
            "landmarks landmark_map; grid forward_map of landmarks");
}

// Each robot's path has a frame of its own there: one grid of all would be one map laid over another.
TEST(ChooseJob, MakesAGridOfEachRobotWhereNothingTiesThemTogether) {
  const ChosenJob chosen = ChooseJob(LogOf({.robots = 2, .scans = 5}));
  EXPECT_EQ(Stages(chosen), "path local_map; grid_0 forward_map of path; grid_1 forward_map of path");
  EXPECT_EQ(chosen.job.stages(1).options().at("robots").s(), "robot 0");
  EXPECT_EQ(chosen.job.stages(2).options().at("robots").s(), "robot 1");
  EXPECT_TRUE(chosen.reasons[0].ends_with(
      "nothing in the log says where its 2 robots stand to each other, so each has a grid of its own"))
      << chosen.reasons[0];
  EXPECT_TRUE(chosen.reasons[2].starts_with("grid_1: forward_map, of 10 readings of robot 'robot 1' in"))
      << chosen.reasons[2];
}

TEST(ChooseJob, OfRobotsOfWhichOneScansTheGridIsIts) {
  Blob log = LogOf({.robots = 2, .scans = 5});
  log = log.Without("robot/0/laser/");
  EXPECT_EQ(Stages(ChooseJob(log)), "path local_map; grid forward_map of path");
}

TEST(ChooseJob, RobotsThatPosesOrLandmarksTieTogetherShareAGrid) {
  for (const Of& of :
       {Of{.robots = 2, .scans = 5, .poses = true}, Of{.robots = 2, .observations = 3, .scans = 5}}) {
    const ChosenJob chosen = ChooseJob(LogOf(of));
    EXPECT_TRUE(Stages(chosen).find("grid_") == std::string::npos) << Stages(chosen);
    EXPECT_FALSE(chosen.job.stages().rbegin()->options().contains("robots"));
  }
}

TEST(ChooseJob, OfMoreRobotsThanAnybodyLooksAtThereIsNoGrid) {
  EXPECT_EQ(ChooseJob(LogOf({.robots = 10, .scans = 5})).job.stages_size(), 11);
  const ChosenJob chosen = ChooseJob(LogOf({.robots = 11, .scans = 5}));
  EXPECT_EQ(Stages(chosen), "path local_map");
  EXPECT_TRUE(chosen.reasons.back().starts_with(
      "no grid: nothing in the log says where its 11 robots stand to each other, and 11 have scans: "))
      << chosen.reasons.back();
}

TEST(ChooseJob, ManyReadingsAreMappedCellByCell) {
  EXPECT_EQ(Stages(ChooseJob(LogOf({.scans = 1'000'001}))), "path local_map; grid evidence_map of path");
}

// Scans of five beams at 3 m, of which those without a return are NaN, or by turns the reach, 10 m: of every
// so many scans the beams from `first` to `last`.
ChosenJob WithLost(int every, std::size_t first, std::size_t last, double beside_rad = 0.02, int scans = 1000,
                   const std::string& sensor_name = "laser") {
  constexpr std::size_t kBeams = 5;
  auto log = Read<Log>(LogOf({.scans = scans, .sensor = sensor_name}));
  std::vector<double> ranges(kBeams * static_cast<std::size_t>(scans), 3.0), headings(kBeams), zero(kBeams);
  for (int at = 0; at < scans; at += every)
    for (std::size_t b = first; b <= last; ++b)
      ranges[kBeams * static_cast<std::size_t>(at) + b] =
          at % 3 == 0 ? 10 : std::numeric_limits<double>::quiet_NaN();
  for (std::size_t b = 0; b < kBeams; ++b) headings[b] = beside_rad * static_cast<double>(b);
  Log::RangeSensor& sensor = log.robot[0].sensors[0];
  sensor.range_m = Column<double>({scans, std::int64_t{kBeams}}, ranges);
  sensor.beam_x_m = sensor.beam_y_m = zero;
  sensor.beam_heading_rad = headings;
  return ChooseJob(BlobOf(log));
}

// Of three beams with two beside them one is lost in every second scan; where it is, its two have none
// beside.
TEST(ChooseJob, BeamsThatAreLostBesideOthersAreAllowedFor) {
  const auto p_lost = [](const ChosenJob& chosen) {
    const auto& options = chosen.job.stages().rbegin()->options();
    return options.contains("p_lost") ? options.at("p_lost").d() : 0;
  };
  const ChosenJob lost = WithLost(2, 2, 2);
  EXPECT_EQ(p_lost(lost), 0.25);  // 500 of 500 and 3 of each of 500
  EXPECT_TRUE(lost.reasons.back().ends_with(
      "; 25.0% of the laser's beams between two that return do not, so p_lost is 0.25"))
      << lost.reasons.back();
  EXPECT_EQ(p_lost(WithLost(50, 2, 2)), 0) << "no more than is taken for granted";
  EXPECT_EQ(p_lost(WithLost(2, 1, 3)), 0) << "glass, or a door";
  EXPECT_EQ(p_lost(WithLost(2, 0, 0)), 0) << "nothing is beside it";
  EXPECT_EQ(p_lost(WithLost(2, 2, 2, 0.1)), 0) << "not beside each other";
  EXPECT_EQ(p_lost(WithLost(2, 2, 2, 0.02, 60)), 0) << "too few to tell";
  EXPECT_EQ(p_lost(WithLost(2, 2, 2, 0.02, 1000, "sonar")), 0);
  const ChosenJob many = WithLost(2, 2, 2, 0.02, 400'001);
  EXPECT_EQ(many.job.stages(1).pipeline(), "evidence_map");
  EXPECT_FALSE(many.job.stages(1).options().at("use_no_return").b());
  EXPECT_FALSE(WithLost(50, 2, 2, 0.02, 400'001).job.stages(1).options().contains("use_no_return"));
}

TEST(ChooseJob, CellsFitTheSensorAndGrowWithTheArea) {
  const auto cell_m = [](const Of& of) {
    return ChooseJob(LogOf(of)).job.stages().rbegin()->options().at("cell_m").d();
  };
  EXPECT_EQ(cell_m({.scans = 5}), 0.05);
  EXPECT_EQ(cell_m({.scans = 5, .sensor = "sonar"}), 0.1);
  // 3 km by 6 m: 18,036 m² hold 7.2 million cells of 0.05 m.
  EXPECT_EQ(cell_m({.scans = 5, .forward_m = 1500}), 0.1);
}

TEST(ChooseJob, EveryStageHasAReason) {
  for (const Of& of : {Of{.observations = 3}, Of{.scans = 5}, Of{.observations = 3, .scans = 5},
                       Of{.robots = 2, .scans = 5}}) {
    const ChosenJob chosen = ChooseJob(LogOf(of));
    ASSERT_EQ(chosen.reasons.size(), static_cast<std::size_t>(chosen.job.stages_size()));
    for (int i = 0; i < chosen.job.stages_size(); ++i)
      EXPECT_TRUE(
          chosen.reasons[static_cast<std::size_t>(i)].starts_with(chosen.job.stages(i).name() + ": "));
  }
}

TEST(ChooseJob, OfARobotWhosePathNobodyCanKnowItSaysSo) {
  EXPECT_THROW(ChooseJob(LogOf({.observations = 3, .odometry = false})), InputError);
  EXPECT_THROW(ChooseJob(LogOf({.observations = 3, .poses = true, .odometry = false})), InputError);
  EXPECT_THROW(ChooseJob(LogOf({.scans = 3, .odometry = false})), InputError);
  EXPECT_EQ(Stages(ChooseJob(LogOf({.scans = 3, .poses = true, .odometry = false}))), "grid forward_map");
}

TEST(ChooseJob, OfARobotThatNoMapCanPlaceItSaysSo) {
  Blob log = LogOf({.robots = 2, .observations = 3});
  for (const char* column : {"time_s", "range_m", "bearing_rad"})
    log.PutVector(std::string("robot/1/observations/") + column, std::vector<double>{});
  log.PutVector("robot/1/observations/landmark", std::vector<std::int32_t>{});
  EXPECT_THROW(ChooseJob(log), InputError);
}

TEST(ChooseJob, OfALogWithNothingToMapItSaysSo) { EXPECT_THROW(ChooseJob(LogOf({})), InputError); }

}  // namespace
}  // namespace cairn::cli
