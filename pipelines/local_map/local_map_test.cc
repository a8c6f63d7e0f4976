// The pipeline as a whole, in one world after another.
#include "pipelines/local_map/local_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "pipelines/local_map/testing/corridor.h"
#include "pipelines/local_map/testing/two_lasers.h"
#include "pipelines/testing/in_process.h"
#include "schema/kinds/local_map.h"

namespace cairn::local_map {
namespace {

constexpr int kLap = 4 * 50;

// A robot that drives round and round a room by odometry whose heading drifts. NaN ranges: `missing` sensors.
Blob RoomLog(int laps, int missing = 0, int jump_at = -1) {
  const std::vector<TestWall> walls = FurnishedRoom();
  Rng rng(4);
  Pose pose{-2, -2, 0};
  std::vector<double> time, turn, forward, range, x, y, heading;
  for (int k = 0; k < laps * kLap; ++k) {
    const double by = k % 50 == 49 ? M_PI / 2 : 0;
    pose = Compose(Compose(pose, {0, 0, by}), {0.08, 0, 0});
    time.push_back(0.2 * (k + 1));
    turn.push_back(by * 1.01 + 0.0004 + 0.002 * rng.Normal());
    forward.push_back(k == jump_at ? 4 : 0.08 * 1.01);
    std::vector<double> scan = SonarScan(walls, pose, 0, rng);
    for (int b = 0; b < missing; ++b) scan[static_cast<std::size_t>(b)] = std::nan("");
    for (double& r : scan)
      if (r > 5) r = std::nan("");
    range.insert(range.end(), scan.begin(), scan.end());
    x.push_back(pose.x_m);
    y.push_back(pose.y_m);
    heading.push_back(std::remainder(pose.heading_rad, 2 * M_PI));
  }
  Blob log;
  log.Put("robots", Array::Texts({"ann"}));
  log.PutVector("robot/0/odometry/time_s", time);
  log.PutVector("robot/0/odometry/turn_rad", turn);
  log.PutVector("robot/0/odometry/forward_m", forward);
  const std::vector<Pose> beams = RingBeams();
  std::vector<double> bx, by, bh;
  for (const Pose& beam : beams) {
    bx.push_back(beam.x_m);
    by.push_back(beam.y_m);
    bh.push_back(std::remainder(beam.heading_rad, 2 * M_PI));
  }
  const std::string sonar = "robot/0/sonar/";
  log.PutVector(sonar + "time_s", time);
  log.Put(sonar + "range_m",
          Array::Of<double>({laps * kLap, static_cast<std::int64_t>(beams.size())}, range));
  log.PutVector(sonar + "beam_x_m", bx);
  log.PutVector(sonar + "beam_y_m", by);
  log.PutVector(sonar + "beam_heading_rad", bh);
  log.PutScalar(sonar + "opening_rad", kTestOpeningRad);
  log.PutScalar(sonar + "max_range_m", 5.0);
  log.PutVector("truth/x_m", x);
  log.PutVector("truth/y_m", y);
  return log;
}

// A robot with a laser that moves by `steps`, of which odometry counts `told`, and drifts.
Blob LaserLog(const std::vector<TestWall>& walls, Pose pose, const std::vector<Pose>& steps,
              const std::vector<Pose>& told) {
  Rng rng(4);
  std::vector<double> time, turn, forward, range, x, y, bx, by, bh;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    pose = Compose(pose, steps[k]);
    time.push_back(0.2 * static_cast<double>(k + 1));
    turn.push_back(told[k].heading_rad * 1.01 + 0.0004 + 0.002 * rng.Normal());
    forward.push_back(told[k].x_m * 1.01);
    const std::vector<double> scan = LaserScan(walls, pose, rng);
    range.insert(range.end(), scan.begin(), scan.end());
    x.push_back(pose.x_m);
    y.push_back(pose.y_m);
  }
  for (const Pose& beam : LaserBeams()) {
    bx.push_back(beam.x_m);
    by.push_back(beam.y_m);
    bh.push_back(beam.heading_rad);
  }
  Blob log;
  log.Put("robots", Array::Texts({"ann"}));
  log.PutVector("robot/0/odometry/time_s", time);
  log.PutVector("robot/0/odometry/turn_rad", turn);
  log.PutVector("robot/0/odometry/forward_m", forward);
  const std::string laser = "robot/0/laser/";
  log.PutVector(laser + "time_s", time);
  log.Put(laser + "range_m",
          Array::Of<double>({static_cast<std::int64_t>(steps.size()), static_cast<std::int64_t>(bh.size())},
                            range));
  log.PutVector(laser + "beam_x_m", bx);
  log.PutVector(laser + "beam_y_m", by);
  log.PutVector(laser + "beam_heading_rad", bh);
  log.PutScalar(laser + "opening_rad", 0.0);
  log.PutScalar(laser + "max_range_m", 10.0);
  log.PutVector("truth/x_m", x);
  log.PutVector("truth/y_m", y);
  return log;
}

// Round and round the room; in turn number `missed` encoders stand still, and along side number `slips`
// wheels slip by 1.2 m in 2 s.
Blob LaserRoomLog(int laps, int missed, int slips = -1) {
  std::vector<Pose> steps, told;
  for (int k = 0; k < laps * kLap; ++k) {
    const int side = k / 50, along = k % 50;
    const bool turns = along >= 40;
    steps.push_back(turns ? Pose{0, 0, M_PI / 20} : Pose{0.08, 0, 0});
    told.push_back(turns && side == missed ? Pose() : steps.back());
    if (side == slips && along >= 10 && along < 20) told.back().x_m += 0.12;
  }
  return LaserLog(FurnishedRoom(), {-1.6, -1.6, 0}, steps, told);
}

// The second of its two lasers is said to sit at `told`.
Blob TwoLaserLog(const Pose& told) {
  const TestLaser ahead{.mount = {0.2, 0, 0}, .told = {0.2, 0, 0}},
      behind{.mount = {-0.2, 0, M_PI}, .told = told};
  const TwoLaserDrive drive({ahead, behind}, FurnishedRoom(), 12);
  Rng rng(4);
  std::vector<double> time, turn, forward;
  for (const Pose& step : drive.steps) {
    time.push_back(0.2 * static_cast<double>(time.size() + 1));
    turn.push_back(step.heading_rad * 1.01 + 0.0004 + 0.002 * rng.Normal());
    forward.push_back(step.x_m * 1.01);
  }
  Blob log;
  log.Put("robots", Array::Texts({"ann"}));
  log.PutVector("robot/0/odometry/time_s", time);
  log.PutVector("robot/0/odometry/turn_rad", turn);
  log.PutVector("robot/0/odometry/forward_m", forward);
  for (std::size_t k = 0; k < 2; ++k) {
    const TestLaser& laser = drive.lasers[k];
    const std::string name = k == 0 ? "robot/0/laser/" : "robot/0/laser2/";
    const std::vector<Pose> beams = laser.Beams(laser.told);
    log.PutVector(name + "time_s", time);
    log.Put(name + "range_m",
            Array::Of<double>({static_cast<std::int64_t>(time.size()), TestLaser::kBeams}, laser.range_m));
    log.PutVector(name + "beam_x_m", cairn::ColumnOf(beams, &Pose::x_m));
    log.PutVector(name + "beam_y_m", cairn::ColumnOf(beams, &Pose::y_m));
    log.PutVector(name + "beam_heading_rad", cairn::ColumnOf(beams, &Pose::heading_rad));
    log.PutScalar(name + "opening_rad", 0.0);
    log.PutScalar(name + "max_range_m", 10.0);
  }
  return log;
}

// Twice along the rows of an empty hall of 20 by 14 m, 2.4 m apart.
Blob HallLog() {
  std::vector<Pose> steps;
  const auto ahead = [&](double m) { steps.insert(steps.end(), std::lround(m / 0.1), Pose{0.1, 0, 0}); };
  const auto turn = [&](int way) { steps.insert(steps.end(), 10, Pose{0, 0, way * M_PI / 20}); };
  for (int lap = 0; lap < 2; ++lap) {
    for (int row = 0; row < 5; ++row) {
      ahead(16);
      const int way = row % 2 == 0 ? 1 : -1;
      turn(way);
      if (row < 4) ahead(2.4);
      turn(way);
    }
  }
  return LaserLog(TestBox(20, 14, {0, 0, 0}), {-8, -4.8, 0}, steps, steps);
}

BlobPtr Map(const Blob& log, const Options& options = {}) {
  const auto without = std::make_shared<const Blob>(log.Without("truth/"));
  return RunInProcess(LocalMap(options, 7), {{"log", without}});
}

// Mean distance between two points of the path, as true and as mapped: no frame needs to be aligned.
double ErrorM(const Blob& log, const Blob& map) {
  const auto tx = log.Get<double>("truth/x_m"), ty = log.Get<double>("truth/y_m");
  const auto x = map.Get<double>("robot/0/poses/x_m"), y = map.Get<double>("robot/0/poses/y_m");
  double sum = 0;
  const std::size_t half = x.size() / 2;
  for (std::size_t k = 0; k < half; ++k) {
    const double truth = std::hypot(tx[k + half] - tx[k], ty[k + half] - ty[k]);
    sum += std::abs(std::hypot(x[k + half] - x[k], y[k + half] - y[k]) - truth);
  }
  return sum / static_cast<double>(half);
}

TEST(LocalMap, FindsLoopsAndThePath) {
  const Blob log = RoomLog(3);
  const BlobPtr map = Map(log);
  EXPECT_LT(ErrorM(log, *map), 0.1);
  EXPECT_GT(map->at("traces/first_z").size(), 8);
  int loops = 0;
  for (const std::int32_t kind : map->Get<std::int32_t>("connections/kind")) loops += kind == 2;
  EXPECT_GT(loops, 20);
  EXPECT_GT(map->at("robot/0/positions/time_s").size(), 200);
  EXPECT_EQ(map->at("robot/0/cuts/time_s").size(), 0);
}

// Walls beside the way tell how far off they are, and only corners how far along it the robot is.
// First the path along the walls, then what was met along it, then both after each round of loops.
TEST(LocalMap, ShowsItsPathsAndWallsAsTheyComeIntoBeing) {
  const auto log = std::make_shared<const Blob>(RoomLog(3).Without("truth/"));
  const LocalMap pipeline(Options(), 7);
  const std::vector<BlobPtr> maps = MapsSoFar(pipeline, {{"log", log}});
  const BlobPtr result = RunInProcess(pipeline, {{"log", log}});
  ASSERT_GT(maps.size(), 3U);
  EXPECT_TRUE(maps.back()->Text("so_far/what").starts_with("round ")) << maps.back()->Text("so_far/what");
  EXPECT_TRUE(maps.front()->Get<double>("so_far/edges/x_m").empty());
  EXPECT_GT(maps.back()->Get<double>("so_far/edges/x_m").size(), 100U);
  for (const char* name : {"time_s", "x_m", "y_m"}) {
    const auto shown = maps.back()->Get<double>("so_far/robot/0/poses/" + std::string(name)),
               found = result->Get<double>("robot/0/poses/" + std::string(name));
    EXPECT_EQ(std::vector<double>(shown.begin(), shown.end()),
              std::vector<double>(found.begin(), found.end()))
        << name;
  }
}

TEST(LocalMap, LoopsSayWhichDistancesTheyTell) {
  const BlobPtr map = Map(RoomLog(3));
  const auto connections = Read<kinds::LocalMap>(*map).connections;
  const auto direction_rad = map->Get<double>("traces/direction_rad");
  int loops = 0, along = 0, across = 0;
  for (std::size_t k = 0; k < connections.kind.vector().size(); ++k) {
    if (connections.kind[k] != 2) continue;
    const auto trace = static_cast<std::size_t>(connections.from[k]);
    const bool is_x = std::abs(std::cos(direction_rad[trace])) > 0.5;
    const bool x = connections.tells_x[k] != 0, y = connections.tells_y[k] != 0;
    EXPECT_TRUE(x || y) << k;
    ++loops;
    along += is_x ? x : y;
    across += is_x ? y : x;
  }
  EXPECT_LT(along, loops);
  EXPECT_GT(across, along);
}

TEST(LocalMap, EveryArrayOfATableIsAsLongAsTheOthers) {
  const BlobPtr map = Map(RoomLog(2));
  const auto same = [&](const char* prefix) {
    std::int64_t rows = -1;
    for (const auto& [name, array] : map->fields()) {
      if (!name.starts_with(prefix) || name.find('/', std::string(prefix).size()) != std::string::npos)
        continue;
      if (rows < 0) rows = array.shape()[0];
      EXPECT_EQ(array.shape()[0], rows) << name;
    }
    EXPECT_GT(rows, 0) << prefix;
  };
  for (const char* prefix : {"robot/0/poses/", "robot/0/walls/", "robot/0/positions/", "traces/",
                             "connections/", "features/left/", "features/right/", "snapshots/"})
    same(prefix);
}

TEST(LocalMap, AJumpOfOdometryCutsTheRunAndTheLoopsJoinItAgain) {
  const Blob log = RoomLog(3, 0, 300);
  const BlobPtr map = Map(log);
  ASSERT_EQ(map->at("robot/0/cuts/time_s").size(), 1);
  EXPECT_EQ(map->Texts("robot/0/cuts/why")[0], "jump");
  EXPECT_LT(ErrorM(log, *map), 0.15);
}

Options Small() {
  Options options;
  options.grid = GridOptions();
  options.ring_beams = 72;
  return options;
}

TEST(LocalMap, InAHallItsGridsReachTheWalls) {
  const Blob log = HallLog();
  const BlobPtr map = Map(log), blind = Map(log, Small());
  EXPECT_LT(ErrorM(log, *map), 0.1);
  EXPECT_LT(ErrorM(log, *map), ErrorM(log, *blind));
  EXPECT_EQ(map->Scalar<double>("cell_m"), 0.3);
  EXPECT_GT(map->at("snapshots/occupancy").shape()[1], 2 * 7 / 0.3);
  EXPECT_EQ(blind->at("snapshots/occupancy").shape()[1], 31);
}

TEST(LocalMap, WhatSeesEnoughWithinTheDefaultKeepsItToTheBit) {
  const Blob log = LaserRoomLog(2, -1);
  EXPECT_EQ(Map(log)->ContentHash(), Map(log, Small())->ContentHash());
}

// Larger grids of the same cells cost more.
TEST(LocalMap, ItsTasksCostKnowsTheSize) {
  const auto log = std::make_shared<const Blob>(HallLog().Without("truth/"));
  const auto later = [&](const Options& options) {
    const Step step = LocalMap(options, 7).Start(MapInputs({{"log", log}}));
    double cost = 0;
    for (const auto& phase : step.plan.later()) cost += static_cast<double>(phase.cost());
    return cost;
  };
  Options large;
  large.grid.half_cells = 60;
  Options less;
  less.grid.half_cells = 20;
  EXPECT_GT(later(large), 1.5 * later(less));
}

TEST(LocalMap, ATurnThatOdometryMissesIsTakenFromTheScans) {
  for (const int missed : {-1, 4}) {
    const Blob log = LaserRoomLog(3, missed);
    const BlobPtr map = Map(log);
    EXPECT_LT(ErrorM(log, *map), 0.1) << missed;
    const auto fit = Read<kinds::LocalMap>(*map).robot[0].fit;
    ASSERT_EQ(fit.from_s.vector().size(), missed < 0 ? 0U : 1U);
    if (missed < 0) continue;
    EXPECT_NEAR(fit.from_s[0], 0.2 * (missed * 50 + 40), 1);
    EXPECT_NEAR(fit.path_turn_rad[0], M_PI / 2, 0.3);
    EXPECT_NEAR(fit.odometry_turn_rad[0], 0, 0.1);
  }
}

TEST(LocalMap, AWayThatWheelsSlipIsTakenFromTheScans) {
  const Blob log = LaserRoomLog(3, -1, 5);
  const BlobPtr map = Map(log);
  EXPECT_LT(ErrorM(log, *map), 0.1);
  const auto fit = Read<kinds::LocalMap>(*map).robot[0].fit;
  ASSERT_EQ(fit.from_s.vector().size(), 1U);
  EXPECT_NEAR(fit.from_s[0], 0.2 * (5 * 50 + 10), 1.5);
  EXPECT_NEAR(fit.odometry_apart_m[0], 1.2, 0.3);
  EXPECT_LT(fit.apart_m[0], 0.3);
}

// What odometry says of its ways is `measured` of them at each time.
Blob Measured(Blob log, const std::function<double(double)>& measured) {
  const auto time_s = log.Get<double>("robot/0/odometry/time_s");
  const auto said = log.Get<double>("robot/0/odometry/forward_m");
  std::vector<double> forward(said.begin(), said.end());
  for (std::size_t k = 0; k < forward.size(); ++k) forward[k] *= measured(time_s[k]);
  log.PutVector("robot/0/odometry/forward_m", forward);
  return log;
}

TEST(LocalMap, OdometrysMetreMayBeFarOff) {
  for (const double measured : {0.65, 1.35}) {
    const Blob log = Measured(LaserRoomLog(3, -1), [&](double) { return measured; });
    const BlobPtr map = Map(log);
    EXPECT_LT(ErrorM(log, *map), 0.1) << measured;
    const auto robot = Read<kinds::LocalMap>(*map).robot[0];
    ASSERT_FALSE(robot.metre.scale.OrNone().empty());
    for (const double scale : robot.metre.scale) EXPECT_NEAR(scale * 1.01 * measured, 1, 0.02);
    EXPECT_TRUE(robot.fit.from_s.OrNone().empty());
  }
}

TEST(LocalMap, OdometrysMetreMayDrift) {
  const auto measured = [](double time_s) { return std::exp(0.2 * std::sin(0.04 * time_s)); };
  const Blob log = Measured(LaserRoomLog(4, -1), measured);
  const BlobPtr map = Map(log);
  EXPECT_LT(ErrorM(log, *map), 0.1);
  const auto metre = Read<kinds::LocalMap>(*map).robot[0].metre;
  ASSERT_FALSE(metre.scale.OrNone().empty());
  for (std::size_t i = 0; i < metre.scale.vector().size(); ++i)
    EXPECT_NEAR(metre.scale[i] * 1.01 * measured(metre.time_s[i]), 1, 0.06) << metre.time_s[i];
}

// On each metre of its way somebody comes towards the robot, at half its speed, and steps aside.
Blob WithPeople(Blob log) {
  const std::size_t beams = LaserBeams().size();
  const auto read = log.Get<double>("robot/0/laser/range_m");
  std::vector<double> range(read.begin(), read.end());
  for (std::size_t k = 0; k < range.size() / beams; ++k) {
    const double away_m = 2.4 - 1.5 * std::fmod(0.08 * static_cast<double>(k % 50), 1.0);
    for (std::size_t b = 0; b < beams; ++b)
      if (k % 50 < 40 && std::abs(LaserBeams()[b].heading_rad) < 0.1)
        range[k * beams + b] = std::min(away_m, std::isnan(read[k * beams + b]) ? 10 : read[k * beams + b]);
  }
  log.Put("robot/0/laser/range_m", Array::Of<double>(log.at("robot/0/laser/range_m").shape(), range));
  return log;
}

TEST(LocalMap, PeopleWhoComeTowardsTheRobotAreNotOdometrysMetre) {
  const Blob log = WithPeople(LaserRoomLog(3, -1));
  const BlobPtr map = Map(log);
  EXPECT_LT(ErrorM(log, *map), 0.1);
  EXPECT_TRUE(Read<kinds::LocalMap>(*map).robot[0].metre.scale.OrNone().empty());
}

// Odometry is read once a second and the laser five times, also amid turns.
TEST(LocalMap, OdometryMayBeReadSeldom) {
  Blob log = LaserRoomLog(3, -1);
  const auto time_s = log.Get<double>("robot/0/odometry/time_s"),
             turn_rad = log.Get<double>("robot/0/odometry/turn_rad"),
             forward_m = log.Get<double>("robot/0/odometry/forward_m");
  std::vector<double> time{0}, turn{0}, forward{0};
  double turned = 0, x_m = 0, y_m = 0;
  for (std::size_t k = 0; k < time_s.size(); ++k) {
    turned += turn_rad[k];
    x_m += forward_m[k] * std::cos(turned);
    y_m += forward_m[k] * std::sin(turned);
    if (k % 5 != 2 && k + 1 < time_s.size()) continue;
    time.push_back(time_s[k]);
    turn.push_back(turned);
    forward.push_back(x_m * std::cos(turned) + y_m * std::sin(turned));
    turned = x_m = y_m = 0;
  }
  log.PutVector("robot/0/odometry/time_s", time);
  log.PutVector("robot/0/odometry/turn_rad", turn);
  log.PutVector("robot/0/odometry/forward_m", forward);
  const BlobPtr map = Map(log);
  EXPECT_LT(ErrorM(log, *map), 0.1);
  EXPECT_TRUE(Read<kinds::LocalMap>(*map).robot[0].fit.from_s.OrNone().empty());
}

TEST(LocalMap, HoldsTwoLasersAgainstEachOther) {
  for (const double off_m : {0.0, 0.6}) {
    const auto map = Read<kinds::LocalMap>(*RunInProcess(
        LocalMap(Options(), 7), {{"log", std::make_shared<Blob>(TwoLaserLog({-0.2 + off_m, 0, M_PI}))}}));
    const kinds::LocalMap::Lasers& lasers = map.robot[0].lasers;
    ASSERT_EQ(lasers.looked.size(), 1U);
    EXPECT_EQ(lasers.first[0], "laser");
    EXPECT_EQ(lasers.second[0], "laser2");
    EXPECT_NEAR(lasers.moved_m[0], off_m, 0.08);
    EXPECT_GT(lasers.moved_share[0], 0.9);
    EXPECT_EQ(lasers.share[0] > 0.9, off_m == 0) << lasers.share[0];
  }
  const auto map = Read<kinds::LocalMap>(
      *RunInProcess(LocalMap(Options(), 7), {{"log", std::make_shared<Blob>(LaserRoomLog(1, -1))}}));
  EXPECT_TRUE(map.robot[0].lasers.looked.OrNone().empty()) << "one laser has no other";
}

TEST(LocalMap, SensorsMayBeMissing) {
  const Blob log = RoomLog(2, 6);
  EXPECT_LT(ErrorM(log, *Map(log)), 0.15);
}

// Three times round corridors about a block of 14.4 by 6.4 m. Along the first, which is blank, odometry tells
// an eighth too much the second time, bit by bit, so that no two scans that follow each other contradict it.
Blob RingLog() {
  std::vector<TestWall> walls = TestBox(20.8, 12.8, {0, 0, 0});
  for (const TestWall& wall : TestBox(14.4, 6.4, {0, 0, 0})) walls.push_back(wall);
  const auto add = [&](double x_m, double y_m, double width_m, double depth_m) {
    for (const TestWall& wall : TestBox(width_m, depth_m, {x_m, y_m, 0})) walls.push_back(wall);
  };
  for (const auto& [x_m, width_m] : {std::pair{-6.0, 0.8}, {-2.5, 1.4}, {1.5, 0.6}, {3.0, 1.1}, {6.5, 0.9}}) {
    add(x_m, 6.2, width_m, 0.4);
  }
  for (const auto& [y_m, width_m] : {std::pair{-3.0, 1.2}, {-0.5, 0.7}, {2.4, 1.0}}) {
    add(10.2, y_m, 0.4, width_m);
    add(-10.2, -y_m + 0.4, 0.4, 1.8 - width_m);
  }
  std::vector<Pose> steps, told;
  for (int side = 0; side < 12; ++side) {
    const long ahead = std::lround((side % 2 == 0 ? 18.4 : 10.4) / 0.1);
    for (long k = 0; k < ahead; ++k) {
      steps.push_back({0.1, 0, 0});
      told.push_back({side == 4 ? 0.1125 : 0.1, 0, 0});
    }
    steps.insert(steps.end(), 10, Pose{0, 0, M_PI / 20});
    told.insert(told.end(), 10, Pose{0, 0, M_PI / 20});
  }
  return LaserLog(walls, {-9.2, -5.2, 0}, steps, told);
}

double ShareFollowed(const Blob& map) {
  const auto connections = Read<kinds::LocalMap>(map).connections;
  double loops = 0, followed = 0;
  for (std::size_t k = 0; k < connections.kind.size(); ++k) {
    if (connections.kind[k] != 2) continue;
    ++loops;
    followed += connections.used[k];
  }
  return followed / loops;
}

double ShareDoubled(const Blob& map) {
  double doubled = 0;
  const auto of = map.Get<std::uint8_t>("robot/0/passes/doubled");
  for (const std::uint8_t is : of) doubled += is;
  return doubled / static_cast<double>(of.size());
}

TEST(LocalMap, APlaceThatIsDrawnTwiceIsSeenAndThePathSoughtAnew) {
  const Blob log = RingLog();
  Options options;
  options.loop_mends = 0;
  const BlobPtr as_it_was = Map(log, options), map = Map(log);
  EXPECT_GT(ShareDoubled(*as_it_was), 0.15);
  EXPECT_GT(ErrorM(log, *as_it_was), 1);
  EXPECT_GT(ShareFollowed(*as_it_was), 0.98) << "loops do not tell";
  EXPECT_LT(ShareDoubled(*map), 0.03);
  EXPECT_LT(ErrorM(log, *map), 0.4);
  // Where no scan contradicts the path it stays as it is.
  const Blob room = LaserRoomLog(3, -1);
  EXPECT_EQ(ShareDoubled(*Map(room)), 0);
  EXPECT_EQ(Map(room)->ContentHash(), Map(room, options)->ContentHash());
}

// The same log of a robot whose base frame is turned by half a circle: by it the robot drives backwards.
Blob TurnedAround(const Blob& log) {
  const auto negated = [&](const char* name) {
    std::vector<double> all;
    for (const double value : log.Get<double>(name)) all.push_back(-value);
    return all;
  };
  Blob turned = log;
  for (const char* name : {"robot/0/odometry/forward_m", "robot/0/laser/beam_x_m", "robot/0/laser/beam_y_m"})
    turned.PutVector(name, negated(name));
  std::vector<double> heading;
  for (const double rad : log.Get<double>("robot/0/laser/beam_heading_rad"))
    heading.push_back(WrapAngle(rad + M_PI));
  turned.PutVector("robot/0/laser/beam_heading_rad", heading);
  return turned;
}

TEST(LocalMap, ARobotThatDrivesBackwardsGetsTheSameMapTurned) {
  const Blob log = LaserRoomLog(3, -1);
  const BlobPtr map = Map(log), turned = Map(TurnedAround(log));
  const auto x = map->Get<double>("robot/0/poses/x_m"), y = map->Get<double>("robot/0/poses/y_m"),
             x_turned = turned->Get<double>("robot/0/poses/x_m"),
             y_turned = turned->Get<double>("robot/0/poses/y_m");
  ASSERT_EQ(x.size(), x_turned.size());
  for (std::size_t k = 0; k < x.size(); ++k) {
    ASSERT_NEAR(x[k], -x_turned[k], 0.01) << k;
    ASSERT_NEAR(y[k], -y_turned[k], 0.01) << k;
  }
  const auto traces = map->Get<double>("traces/direction_rad"),
             traces_turned = turned->Get<double>("traces/direction_rad");
  ASSERT_GT(traces.size(), 8U);
  ASSERT_EQ(traces.size(), traces_turned.size());
  for (std::size_t t = 0; t < traces.size(); ++t)
    EXPECT_NEAR(std::abs(WrapAngle(traces[t] - traces_turned[t])), M_PI, 1e-9) << t;
  const auto features = map->Get<std::int64_t>("traces/features"),
             features_turned = turned->Get<std::int64_t>("traces/features");
  EXPECT_EQ(std::vector(features.begin(), features.end()),
            std::vector(features_turned.begin(), features_turned.end()));
  EXPECT_NEAR(static_cast<double>(map->at("connections/kind").size()),
              static_cast<double>(turned->at("connections/kind").size()), 3);
}

// A laser that gives no answer by a share of its beams, each time by others.
Blob WithLostBeams(Blob log, double share, const std::string& sensor = "robot/0/laser/") {
  const Array whole = log.at(sensor + "range_m");
  std::vector<double> ranges(whole.As<double>().begin(), whole.As<double>().end());
  Rng rng(6);
  for (double& range : ranges)
    if (rng.Uniform() < share) range = std::nan("");
  log.Put(sensor + "range_m", Array::Of<double>(whole.shape(), ranges));
  return log;
}

TEST(LocalMap, LostBeamsHideNoPlaceThatIsDrawnTwice) {
  const Blob log = WithLostBeams(RingLog(), 0.3);
  Options options;
  options.loop_mends = 0;
  const BlobPtr as_it_was = Map(log, options), map = Map(log);
  EXPECT_GT(ShareDoubled(*as_it_was), 0.15);
  EXPECT_LT(ShareDoubled(*map), 0.03);
  EXPECT_LT(ErrorM(log, *map), 0.4);
}

TEST(LocalMap, LostBeamsHideNoMotionThatOdometryMisses) {
  for (const auto& [missed, slips] : {std::pair{4, -1}, {-1, 5}}) {
    const Blob log = WithLostBeams(LaserRoomLog(3, missed, slips), 0.4);
    const BlobPtr map = Map(log);
    EXPECT_LT(ErrorM(log, *map), 0.1);
    EXPECT_EQ(Read<kinds::LocalMap>(*map).robot[0].fit.from_s.vector().size(), 1U);
  }
}

TEST(LocalMap, RefusesALogWithoutRangesOrWithTimeThatRunsBackwards) {
  const Blob log = RoomLog(1);
  const auto refusal = [](const Blob& bad) -> std::string {
    try {
      Map(bad);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(refusal(log.Without("robot/0/sonar/")).find("no range"), std::string::npos);
  Blob backwards = log;
  const auto time = log.Get<double>("robot/0/sonar/time_s");
  std::vector<double> times(time.begin(), time.end());
  times[5] = 0;
  backwards.PutVector("robot/0/sonar/time_s", times);
  EXPECT_NE(refusal(backwards).find("'robot/0/sonar/time_s', entry 5"), std::string::npos);

  constexpr std::int64_t kBeams = 20'001;
  Blob fine = log;
  const std::vector<double> beams(kBeams, 0.0), ranges(2 * kBeams, 1.0);
  fine.PutVector("robot/0/sonar/time_s", std::vector<double>{times[0] + 1, times[1] + 1});
  fine.Put("robot/0/sonar/range_m", Array::Of<double>({2, kBeams}, ranges));
  for (const char* name : {"beam_x_m", "beam_y_m", "beam_heading_rad"})
    fine.PutVector(std::string("robot/0/sonar/") + name, beams);
  EXPECT_NE(refusal(fine).find("a scan of 20001 beams"), std::string::npos) << refusal(fine);
}

}  // namespace
}  // namespace cairn::local_map
