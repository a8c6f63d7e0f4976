#include "pipelines/common/range_scans.h"

#include <gtest/gtest.h>

#include <cmath>

#include "schema/error.h"
#include "schema/kinds/kind.h"

namespace cairn {
namespace {

const double kNone = std::nan("");

// Two beams, ahead and to the left, that begin 0.2 m ahead of the robot's centre; it drives along x.
Blob Log() {
  Blob log;
  log.Put("robots", Array::Texts({"ann"}));
  log.PutVector<double>("robot/0/poses/time_s", {0, 10});
  log.PutVector<double>("robot/0/poses/x_m", {0, 10});
  log.PutVector<double>("robot/0/poses/y_m", {0, 0});
  log.PutVector<double>("robot/0/poses/heading_rad", {0, 0});
  const std::string sonar = "robot/0/sonar/";
  log.PutVector<double>(sonar + "time_s", {0, 5, 10});
  log.Put(sonar + "range_m", Array::Of<double>({3, 2}, std::vector<double>{1, 2, kNone, 3, 4, kNone}));
  log.PutVector<double>(sonar + "beam_x_m", {0.2, 0.2});
  log.PutVector<double>(sonar + "beam_y_m", {0, 0});
  log.PutVector<double>(sonar + "beam_heading_rad", {0, M_PI / 2});
  log.PutScalar<double>(sonar + "opening_rad", 0.26);
  log.PutScalar<double>(sonar + "max_range_m", 6);
  return log;
}

// The same of two robots, "ann" and "bob", by poses of their own.
Blob LogOfTwo() {
  Blob log = Log();
  log.Put("robots", Array::Texts({"ann", "bob"}));
  log.PutAll("robot/1/", Log().Sub("robot/0/"));
  log.PutVector<double>("robot/1/poses/x_m", {3, 3});
  return log;
}

// And by dead reckoning.
Blob LogOfTwoByOdometry() {
  Blob log = LogOfTwo();
  for (const char* robot : {"robot/0/", "robot/1/"}) {
    const std::string odometry = std::string(robot) + "odometry/";
    log = log.Without(std::string(robot) + "poses/");
    log.PutVector<double>(odometry + "time_s", {0, 10});
    log.PutVector<double>(odometry + "turn_rad", {0, 0});
    log.PutVector<double>(odometry + "forward_m", {0, 10});
  }
  return log;
}

std::string Refusal(const Blob& log, const GridOptions& options = {}, const Blob* poses = nullptr) {
  try {
    CheckInput(log, "log");  // as before a job starts
    GridOf(ReadRangeScans(log, poses, options), options, 8);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(RangeScans, AreReadWithTheirPosesAndBeams) {
  const PosedScans scans = ReadRangeScans(Log(), nullptr, {});
  ASSERT_EQ(scans.sensors.size(), 1U);
  const RangeScans& sonar = scans.sensors[0];
  ASSERT_EQ(sonar.scans(), 3U);
  const Pose beam = sonar.BeamPose(1, 1);
  EXPECT_DOUBLE_EQ(beam.x_m, 5.2);
  EXPECT_DOUBLE_EQ(beam.heading_rad, M_PI / 2);
}

// Beams on a turret point where it does, scan by scan, in tasks too, and what they meet belongs to the map.
TEST(RangeScans, BeamsTurnWithTheirTurretRowByRow) {
  Blob log = Log();
  log.PutVector<double>("robot/0/sonar/turret_rad", {0, M_PI / 2, M_PI});
  const PosedScans scans = ReadRangeScans(log, nullptr, {});
  const RangeScans& sonar = scans.sensors[0];
  const Pose beam = sonar.BeamPose(1, 0), last = sonar.BeamPose(2, 1);
  EXPECT_NEAR(beam.x_m, 5, 1e-12);
  EXPECT_NEAR(beam.y_m, 0.2, 1e-12);
  EXPECT_DOUBLE_EQ(beam.heading_rad, M_PI / 2);
  EXPECT_NEAR(last.x_m, 9.8, 1e-12);
  const RangeScans task = ScansOf(SensorBlob(sonar), ScansBlob(sonar), log);
  for (std::size_t s = 0; s < 3; ++s) {
    for (std::size_t b = 0; b < 2; ++b) {
      const Pose here = sonar.BeamPose(s, b), there = task.BeamPose(s, b);
      EXPECT_EQ(here.x_m, there.x_m);
      EXPECT_EQ(here.heading_rad, there.heading_rad);
    }
  }
  // The last scan's beam of 4 m, which would point ahead, looks back.
  const GridOptions options;
  const GridBox turned = GridOf(scans, options, 8),
                plain = GridOf(ReadRangeScans(Log(), nullptr, options), options, 8);
  EXPECT_LT(turned.origin_x_m + static_cast<double>(turned.columns) * turned.cell_m,
            plain.origin_x_m + static_cast<double>(plain.columns) * plain.cell_m - 3);
  log.PutVector<double>("robot/0/sonar/turret_rad", {0, 1});
  EXPECT_NE(Refusal(log).find("turret_rad' has the shape [2]"), std::string::npos) << Refusal(log);
  log.PutVector<double>("robot/0/sonar/turret_rad", {0, kNone, 0});
  EXPECT_NE(Refusal(log).find("turret_rad', entry 1"), std::string::npos) << Refusal(log);
}

TEST(RangeScans, InfraredIsASensorOfItsOwn) {
  Blob log = Log();
  log.PutAll("robot/0/infrared/", Log().Sub("robot/0/sonar/"));
  EXPECT_EQ(ReadRangeScans(log, nullptr, {}).sensors[1].name, "robot/0/infrared/");
  GridOptions options;
  options.sensors = "infrared";
  EXPECT_EQ(ReadRangeScans(log, nullptr, options).sensors.size(), 1U);
}

TEST(RangeScans, ARobotMayHaveSeveralLasers) {
  Blob log = Log();
  log.PutAll("robot/0/laser2/", Log().Sub("robot/0/sonar/"));
  log.PutScalar<double>("robot/0/laser2/opening_rad", 0);
  const PosedScans scans = ReadRangeScans(log, nullptr, {});
  ASSERT_EQ(scans.sensors.size(), 2U);
  EXPECT_EQ(scans.sensors[1].name, "robot/0/laser2/");
  GridOptions options;
  options.sensors = "laser2";
  EXPECT_EQ(ReadRangeScans(log, nullptr, options).sensors.size(), 1U);
}

TEST(RangeScans, TheGridHoldsPosesAndAllThatWasMet) {
  GridOptions options;
  options.cell_m = 0.5;
  const GridBox box = GridOf(ReadRangeScans(Log(), nullptr, options), options, 8);
  EXPECT_DOUBLE_EQ(box.origin_x_m, -0.5);
  EXPECT_DOUBLE_EQ(box.origin_y_m, -0.5);
  EXPECT_EQ(box.ColumnOf(14.2 + 0.49), box.columns - 1);
  EXPECT_EQ(box.RowOf(3 + 0.5), box.rows - 1);
}

TEST(RangeScans, TheLastPartOfEachTenthIsHeldOut) {
  Blob log = Log();
  std::vector<double> time, range;
  for (int s = 0; s < 200; ++s) {
    time.push_back(0.05 * s);
    range.insert(range.end(), {1, 1});
  }
  log.PutVector("robot/0/sonar/time_s", time);
  log.Put("robot/0/sonar/range_m", Array::Of<double>({200, 2}, range));
  GridOptions options;
  options.heldout = 0.1;
  const PosedScans scans = ReadRangeScans(log, nullptr, options);
  std::vector<int> out;
  for (int s = 0; s < 200; ++s)
    if (scans.sensors[0].held_out[s]) out.push_back(s);
  EXPECT_EQ(out, (std::vector<int>{18,  19,  38,  39,  58,  59,  78,  79,  98,  99,
                                   118, 119, 138, 139, 158, 159, 178, 179, 198, 199}));
}

// However few there are: of 40 scans each tenth has four, none of which is in its last tenth.
TEST(RangeScans, SomeAreHeldOutOfAnyTwo) {
  for (const double share : {0.01, 0.05, 0.1, 0.3}) {
    for (std::size_t count = 2; count <= 130; ++count) {
      Blob log = Log();
      std::vector<double> time, range(2 * count, 1);
      for (std::size_t s = 0; s < count; ++s) time.push_back(0.05 * static_cast<double>(s));
      log.PutVector("robot/0/sonar/time_s", time);
      log.Put("robot/0/sonar/range_m", Array::Of<double>({static_cast<std::int64_t>(count), 2}, range));
      GridOptions options;
      options.heldout = share;
      const RangeScans some = ReadRangeScans(log, nullptr, options).sensors[0];
      const auto out = std::ranges::count(some.held_out, 1);
      ASSERT_GE(out, 1) << count << " scans, " << share;
      ASSERT_LT(out, static_cast<std::int64_t>(count)) << share;
      options.heldout = 0;
      ASSERT_GE(std::ranges::count(ReadRangeScans(log, nullptr, options).sensors[0].checked, 1), 1) << count;
    }
  }
}

// A driver may write the sensor's reach where nothing came back, rounded to f32 or not.
TEST(RangeScans, AReadingAtTheReachMetNothing) {
  for (const double at_reach : {6.0, 5.999999, 6.000001}) {
    Blob log = Log();
    log.Put("robot/0/sonar/range_m",
            Array::Of<double>({3, 2}, std::vector<double>{1, at_reach, 5.99, 3, at_reach, kNone}));
    EXPECT_EQ(Refusal(log), "accepted");
    const RangeScans whole = ReadRangeScans(log, nullptr, {}).sensors[0];
    const RangeScans task = ScansOf(SensorBlob(whole), ScansBlob(whole), log);
    for (const RangeScans& sonar : {whole, task}) {
      const auto range = sonar.range_m.As<double>();
      EXPECT_TRUE(std::isnan(range[1]) && std::isnan(range[4]) && std::isnan(range[5])) << at_reach;
      EXPECT_EQ(range[2], 5.99);
    }
    const Extent ends = EndsOf(whole);
    EXPECT_LT(ends.y1_m(), 3.1) << "none met anything 6 m to the left";
  }
}

TEST(RangeScans, TasksTakeRowsOfThem) {
  const Blob log = Log();
  const RangeScans whole = ReadRangeScans(log, nullptr, {}).sensors[0];
  const Blob sensor = SensorBlob(whole), scans = ScansBlob(whole);
  Blob rows;
  for (const auto& [name, array] : scans.fields()) rows.Put(name, array.Rows(1, 2));
  const RangeScans part = ScansOf(sensor, rows, log);
  ASSERT_EQ(part.scans(), 2U);
  EXPECT_EQ(part.name, "robot/0/sonar/");
  EXPECT_EQ(part.pose[1].x_m, 10);
  EXPECT_EQ(part.range_m.As<double>()[1], 3);
  EXPECT_EQ(part.opening_rad, 0.26);
}

TEST(RangeScans, RangesOfATaskThatLieAlignedAreNotCopied) {
  constexpr std::size_t kScans = 20, kBeams = 2;
  Blob log = Log();
  std::vector<double> times, ranges;
  for (std::size_t s = 0; s < kScans; ++s) times.push_back(0.5 * static_cast<double>(s));
  for (std::size_t r = 0; r < kScans * kBeams; ++r) ranges.push_back(0.1 * static_cast<double>(r));
  log.PutVector("robot/0/sonar/time_s", times);
  log.Put("robot/0/sonar/range_m", Array::Of<double>({kScans, kBeams}, ranges));
  const RangeScans whole = ReadRangeScans(log, nullptr, {}).sensors[0];
  const Blob scans = ScansBlob(whole);
  const auto all = log.Get<double>("robot/0/sonar/range_m");
  for (const std::int64_t first : {0, 8, 9, 16}) {
    Blob rows;
    for (const auto& [name, array] : scans.fields()) rows.Put(name, array.Rows(first, 4));
    const RangeScans part = ScansOf(SensorBlob(whole), rows, log);
    const auto range = part.range_m.As<double>();
    EXPECT_EQ(part.range_m.shape(), (Shape{4, kBeams}));
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(range.data()) % 64, 0U) << first;
    EXPECT_EQ(range.data() == all.data() + static_cast<std::size_t>(first) * kBeams, first % 8 == 0) << first;
    for (std::size_t r = 0; r < range.size(); ++r)
      EXPECT_EQ(range[r], ranges[static_cast<std::size_t>(first) * kBeams + r]);
  }
}

TEST(RangeScans, AResultSaysWhereTheRobotWasAtEachScan) {
  GridOptions options;
  options.heldout = 0.9;
  Blob result, log = Log();
  PutScanPoses(ReadRangeScans(log, nullptr, options), log, &result);
  EXPECT_EQ(result.Get<double>("robot/0/sonar/x_m")[1], 5);
  EXPECT_EQ(result.Get<std::uint8_t>("robot/0/sonar/held_out")[0], 0);
  EXPECT_EQ(result.Get<std::uint8_t>("robot/0/sonar/held_out")[1], 1);
  log.PutVector<double>("truth/walls/x_m", {1});
  EXPECT_EQ(result.Text("log_hash"), log.Without("truth/").ContentHash().Hex());
}

TEST(RangeScans, PosesThatAreAnotherLogsAreRefused) {
  Blob log = Log(), poses = Log();
  EXPECT_EQ(Refusal(log, {}, &poses), "accepted") << "a table does not say of which log it is";
  poses.Put("log_hash", Array::Text(log.ContentHash().Hex()));
  log.Put("truth/walls/x_m", Array::Of<double>({1, 2}, std::vector<double>{1, 2}));
  log.Put("truth/walls/y_m", Array::Of<double>({1, 2}, std::vector<double>{1, 2}));
  EXPECT_EQ(Refusal(log, {}, &poses), "accepted");
  log.PutScalar<double>("robot/0/sonar/max_range_m", 7);
  const std::string refusal = Refusal(log, {}, &poses);
  EXPECT_NE(refusal.find("the input 'poses' was made from another log: "), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("`cairn export tum` and `cairn import tum`"), std::string::npos) << refusal;
}

TEST(RangeScans, ScansOutsideTheTimeOfPosesAreRefusedOrLeftOut) {
  Blob log = Log();
  log.PutVector<double>("robot/0/sonar/time_s", {0, 5, 10.5});
  EXPECT_NE(Refusal(log).find("scan 2 (10.500000 s): there is no pose for this time"), std::string::npos);
  GridOptions options;
  options.skip_unposed = true;
  const PosedScans scans = ReadRangeScans(log, nullptr, options);
  EXPECT_EQ(scans.unposed, 1U);
  EXPECT_EQ(scans.sensors[0].range_m.shape(), (Shape{2, 2}));
  log.PutVector<double>("robot/0/sonar/time_s", {0, 5, 10});
  log.PutVector<double>("robot/0/poses/time_s", {5, 10});
  const RangeScans late = ReadRangeScans(log, nullptr, options).sensors[0];
  const RangeScans of_task = ScansOf(SensorBlob(late), ScansBlob(late), log);
  EXPECT_EQ(of_task.row, (std::vector<std::int64_t>{1, 2}));
  EXPECT_EQ(of_task.range_m.As<double>()[1], 3) << "the second scan's";
}

TEST(RangeScans, TheOptionSaysWhose) {
  const auto sensors = [](const std::string& robots, const Blob& log = LogOfTwo()) {
    GridOptions options;
    options.robots = robots;
    std::string names;
    for (const RangeScans& sensor : ReadRangeScans(log, nullptr, options).sensors) names += sensor.name + " ";
    return names;
  };
  EXPECT_EQ(sensors(""), "robot/0/sonar/ robot/1/sonar/ ");
  EXPECT_EQ(sensors("bob"), "robot/1/sonar/ ");
  EXPECT_EQ(sensors("bob, ann"), "robot/0/sonar/ robot/1/sonar/ ") << "in the log's order";
  Blob odd = LogOfTwo();
  odd.Put("robots", Array::Texts({"ann, bob", "bob"}));
  EXPECT_EQ(sensors("ann, bob", odd), "robot/0/sonar/ ") << "the name of one";
  GridOptions options;
  options.robots = "ann,carl";
  EXPECT_EQ(Refusal(LogOfTwo(), options),
            "option 'robots': the log has no robot 'carl', it has 'ann', 'bob'");
  options.robots = " ,";
  EXPECT_EQ(Refusal(LogOfTwo(), options), "option 'robots': ' ,' names none");
  options.robots = "bob";
  EXPECT_NE(Refusal(LogOfTwo().Without("robot/1/sonar/"), options).find("no range scans by robot 'bob'"),
            std::string::npos);
}

// Whoever is not chosen need not have a pose, or a right one.
TEST(RangeScans, OfOtherRobotsNothingIsAsked) {
  GridOptions options;
  options.robots = "bob";
  EXPECT_EQ(Refusal(LogOfTwo().Without("robot/0/poses/"), options), "accepted");
}

TEST(RangeScans, RobotsWithoutACommonFrameMakeNoMap) {
  EXPECT_EQ(Refusal(LogOfTwo()), "accepted");
  const Blob reckoned = LogOfTwoByOdometry();
  EXPECT_EQ(Refusal(reckoned),
            "the scans are of 2 robots, and nothing says how their paths lie beside each other: 'ann', 'bob' "
            "have a frame each, for the poses are dead reckoning's or a local_map's. Make a map of one robot "
            "(robots=NAME), or give poses of one frame: a landmark_map, or a file of poses, as the input "
            "'poses'");
  EXPECT_EQ(ReadRangeScans(reckoned, nullptr, {}).sensors.size(), 2U) << "to read them is no mistake";
  GridOptions one;
  one.robots = "bob";
  EXPECT_EQ(Refusal(reckoned, one), "accepted");
  EXPECT_EQ(Refusal(reckoned.Without("robot/0/sonar/")), "accepted") << "one of them has scans";
  Blob half = reckoned;
  half.PutAll("robot/0/poses/", LogOfTwo().Sub("robot/0/poses/"));
  EXPECT_NE(Refusal(half).find("each other: 'bob' has a frame of its own"), std::string::npos);
  Blob poses;
  poses.Put("robots", Array::Texts({"ann", "bob"}));
  for (const char* robot : {"robot/0/poses/", "robot/1/poses/"}) poses.PutAll(robot, LogOfTwo().Sub(robot));
  EXPECT_EQ(Refusal(reckoned, {}, &poses), "accepted");
  poses.PutVector<std::int32_t>("traces/first_z", {});  // a local_map
  EXPECT_NE(Refusal(LogOfTwo(), {}, &poses).find("'ann', 'bob' have a frame each"), std::string::npos);
}

TEST(RangeScans, WhatIsWrongIsNamedWithSensorAndScan) {
  const auto with = [](const std::string& name, Array array) {
    Blob log = Log();
    log.Put("robot/0/sonar/" + name, std::move(array));
    return Refusal(log);
  };
  const auto ranges = [&](double bad) {
    return with("range_m", Array::Of<double>({3, 2}, std::vector<double>{1, 2, 3, bad, 4, 5}));
  };
  EXPECT_EQ(Refusal(Log()), "accepted");
  EXPECT_NE(ranges(-0.1).find("range_m', entry 3: -0.1"), std::string::npos);
  EXPECT_NE(ranges(6.1).find("scan 1 (5.000000 s): beam 1 measures 6.1"), std::string::npos);
  EXPECT_NE(ranges(1 / 0.0).find("range_m', entry 3: inf"), std::string::npos);
  EXPECT_NE(with("range_m", Array::Of<double>({2, 2}, std::vector<double>{1, 2, 3, 4}))
                .find("range_m' has the shape [2,2]"),
            std::string::npos);
  EXPECT_NE(with("time_s", Array::Vector<double>({0, 7, 5})).find("time_s', entry 2"), std::string::npos);
  EXPECT_NE(with("opening_rad", Array::Scalar<double>(4)).find("opening_rad': 4"), std::string::npos);
  EXPECT_NE(with("beam_x_m", Array::Vector<double>({0})).find("beam_x_m' has the shape [1]"),
            std::string::npos);
  Blob none = Log().Without("robot/0/sonar/");
  EXPECT_NE(Refusal(none).find("the log has no range scans"), std::string::npos);
  GridOptions options;
  options.sensors = "radar";
  EXPECT_NE(Refusal(Log(), options).find("no 'radar'"), std::string::npos);
  options.sensors = "laser";
  EXPECT_NE(Refusal(Log(), options).find("no range scans of 'laser'"), std::string::npos);
  options = {};
  options.box_m = "-1,-1,5,5";
  EXPECT_NE(Refusal(Log(), options).find("too small for the trajectory"), std::string::npos);
  options = {};
  options.cell_m = 0.001;
  options.memory_mb = 10;
  EXPECT_NE(Refusal(Log(), options).find("memory_mb allows"), std::string::npos);
}

}  // namespace
}  // namespace cairn
