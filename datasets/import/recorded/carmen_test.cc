#include "datasets/import/recorded/carmen.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "datasets/evaluate/relations.h"
#include "datasets/evaluate/track.h"
#include "datasets/testing.h"

namespace cairn::datasets {
namespace {

constexpr double kPi = std::numbers::pi;

std::string Many(int count, const std::string& value) {
  std::string text;
  for (int i = 0; i < count; ++i) text += " " + value;
  return text;
}

// FLASER of 180 beams of 2 m: poses of laser and robot, time.
std::string Flaser(const std::string& laser, const std::string& robot, const std::string& time) {
  return "FLASER 180" + Many(180, "2") + " " + laser + " " + robot + " " + time + " host " + time + "\n";
}

class ImportCarmenTest : public ImportTest {
 protected:
  CarmenImportOptions options_;
  ImportReport Import(const std::string& text, const std::string& name = "log.log") {
    options_.path = folder_.Put(name, text);
    return ImportCarmen(options_, &log_);
  }
  std::string Refusal(const std::string& text) {
    return InputErrorOf([&] { Import(text); });
  }
  std::int64_t Beams(const std::string& sensor) const {
    return log_.at("robot/0/" + sensor + "/range_m").shape().at(1);
  }
};

TEST_F(ImportCarmenTest, OldMessagesOfARawLogBecomeControlsAndScans) {
  const ImportReport report = Import(
      "# CARMEN Logfile\n\nPARAM robot_front_laser_max 20 0 host 0\n"
      "ODOM 0 0 0 1 0 0 10.0 host 10.1\n" +
          Flaser("0.3 0 0", "0 0 0", "10.5") + "ODOM 1 0 0 1 0 0 11 host 11.1\r\n" +
          Flaser("1.3 0 0", "1 0 0", "11.5") + "SYNC tag 12 host 12\n",
      "log.log.gz");
  EXPECT_EQ(report.scans, 2);
  EXPECT_EQ(report.read, (std::map<std::string, std::int64_t>{{"FLASER", 2}, {"ODOM", 2}, {"PARAM", 1}}));
  EXPECT_EQ(report.dropped.at("SYNC, which is not used"), 1);
  EXPECT_TRUE(report.warnings.empty());
  EXPECT_EQ(Column<double>("robot/0/odometry/time_s"), (std::vector<double>{10, 10.5, 11, 11.5}));
  EXPECT_EQ(Column<double>("robot/0/odometry/forward_m"), (std::vector<double>{0, 0, 1, 0}));
  EXPECT_EQ(Column<double>("robot/0/laser/time_s"), (std::vector<double>{10.5, 11.5}));
  EXPECT_EQ(log_.Scalar<double>("robot/0/laser/max_range_m"), 20);
  EXPECT_NEAR(Column<double>("robot/0/laser/beam_x_m")[7], 0.3, 1e-12);
  EXPECT_NEAR(Column<double>("robot/0/laser/beam_heading_rad")[0], -kPi / 2, 1e-12);
  EXPECT_NEAR(Column<double>("robot/0/laser/beam_heading_rad")[179], kPi / 2 - kPi / 180, 1e-12);
  EXPECT_FALSE(log_.Has("robot/0/poses/time_s"));
}

TEST_F(ImportCarmenTest, PosesOfAMendedLogAreATableThatHasEachScansPoseAtItsTime) {
  const std::string log = "NEFF 15\nODOM 0 0 0 0 0 0 9 p 9\nODOM 1 0 0 0 0 0 10 p 10\n" +
                          Flaser("1.5 0.1 0.2", "1.5 0.1 0.2", "10") + "ODOM 1.5 0.1 0.2 0 0 0 0 p 0\n" +
                          Flaser("3 0 0.1", "3 0 0.1", "11.5") + Flaser("2 0 0.1", "2 0 0.1", "11") +
                          Flaser("4 0 0", "4 0 0", "11.5") + "ODOM 9 9 9 0 0 0 2 p 2\n";
  const ImportReport report = Import(log);
  EXPECT_EQ(report.dropped.at("pose without a time stamp above 0"), 1);
  EXPECT_EQ(report.dropped.at("pose whose time stamp is more than 1 s behind"), 1);
  const Track track = ReadTrack(log_, "robot/0/poses/");
  EXPECT_EQ(track.time_s, (std::vector<double>{9, 10, 11, 11.5, 11.5 + 1e-6}));
  const auto times = Column<double>("robot/0/laser/time_s");
  ASSERT_EQ(times.size(), 4U);
  const std::vector<double> x{1.5, 2, 3, 4};
  for (std::size_t s = 0; s < times.size(); ++s) EXPECT_EQ(PoseAt(track, times[s]).value().x_m, x[s]) << s;
  EXPECT_EQ(Column<double>("robot/0/laser/beam_x_m")[0], 0);

  options_.poses = CarmenImportOptions::Poses::kRaw;
  Import(log);
  EXPECT_FALSE(log_.Has("robot/0/poses/time_s"));
}

TEST_F(ImportCarmenTest, AMendedLaserPoseBesideRawOdometryIsDetected) {
  const std::string log = "PARAM robot_frontlaser_offset 0.5 0 host 0\n" + Flaser("0.5 0 0", "0 0 0", "1") +
                          Flaser("1.5 0.2 0", "1 0 0.3", "2");
  Import(log);
  EXPECT_EQ(Column<double>("robot/0/poses/x_m"), (std::vector<double>{0, 1}));
  EXPECT_EQ(Column<double>("robot/0/poses/y_m"), (std::vector<double>{0, 0.2}));
  EXPECT_EQ(Column<double>("robot/0/laser/beam_x_m")[0], 0.5);
  EXPECT_NEAR(Column<double>("robot/0/odometry/forward_m")[1], 1, 1e-12);
  options_.mounts["laser"] = {0.1, 0, kPi / 2};
  Import(log);
  EXPECT_NEAR(Column<double>("robot/0/poses/y_m")[0], 0.1, 1e-12);
  EXPECT_NEAR(Column<double>("robot/0/poses/heading_rad")[0], -kPi / 2, 1e-12);
}

TEST_F(ImportCarmenTest, NewMessagesSayTheirGeometry) {
  const std::string config = "0 -1.0 2.0 0.5 8 0.01 0 4 1 2 8.5 0 1 77 ";
  const ImportReport report =
      Import("RAWLASER1 " + config + "1 host 1\nROBOTLASER1 " + config +
             "0.2 0 0 0 0 0 0 0 0 0 0 1 host 1\n" + "ODOM 0 0 0 0 0 0 0.5 host 0.5\n" +
             "RAWLASER2 0 -1.5 3 1 9 0.01 0 3 1 2 3 0 2 host 2\n"
             "SONAR 0.26 2 1.5 5 0.2 0.1 0.7 0.2 -0.1 -0.7 2 host 2\n"
             "TRUEPOS 0.1 0 0 0 0 0 1 host 1\nODOM 2 0 0 0 0 0 3 host 3\nRAWLASER2 0 -1.5 3 1 9 0.01 0 3 1 2 "
             "3 0 4 host 4\n");
  EXPECT_EQ(report.dropped.at("RAWLASER1, of which another message holds the same"), 1);
  EXPECT_EQ(report.dropped.at("scan outside the odometry's time"), 1);
  EXPECT_EQ(report.read.count("RAWLASER1"), 0U);
  EXPECT_EQ(Beams("laser"), 4);
  const auto range = Column<double>("robot/0/laser/range_m");
  EXPECT_EQ(range[1], 2);
  EXPECT_TRUE(std::isnan(range[2]) && std::isnan(range[3])) << "beyond 8 m, and 0";
  EXPECT_EQ(Column<double>("robot/0/laser/beam_heading_rad"), (std::vector<double>{-1, -0.5, 0, 0.5}));
  EXPECT_EQ(Beams("laser2"), 3);
  EXPECT_NEAR(Column<double>("robot/0/laser2/beam_heading_rad")[1], kPi - 0.5, 1e-12) << "it looks back";
  EXPECT_EQ(log_.Scalar<double>("robot/0/sonar/opening_rad"), 0.26);
  EXPECT_EQ(Column<double>("robot/0/sonar/beam_heading_rad"), (std::vector<double>{0.7, -0.7}));
  EXPECT_TRUE(std::isnan(Column<double>("robot/0/sonar/range_m")[1]));
  EXPECT_EQ(Column<double>("truth/robot/0/poses/x_m"), (std::vector<double>{0.1}));
}

// Numbers of our own in the forms that CARMEN's logger prints: carmen_logwrite_write_robot_laser,
// …_laser_laser, …_base_sonar, …_param, …_truepos and …_odometry of src/logger/logwrite.c (a blank behind
// each list, six digits, ranges of three, of sonars two); FLASER and RLASER as the header of its older
// revisions says; RAWLASER4 as the first revision that had it, without a remission mode.
TEST_F(ImportCarmenTest, ReadsWhatCarmensLoggerWrites) {
  const ImportReport report = Import(
      "# CARMEN Logfile\n# file format is one message per line\n"
      "# message_name [message contents] ipc_timestamp ipc_hostname logger_timestamp\n"
      "PARAM robot_frontlaser_offset 0.25 1127233281.000000 robot 0.500000\n"
      "ODOM 0.000000 0.000000 0.000000 0.100000 0.000000 0.000000 1127233280.000000 robot 0.900000\n"
      "ROBOTLASER1 0 -1.570796 3.141593 1.570796 80.000000 0.010000 0 3 1.000 2.500 81.910 0 "
      "0.250000 0.000000 0.000000 0.000000 0.000000 0.000000 0.000000 0.000000 0.000000 0.000000 0.000000 "
      "1127233281.000000 robot 1.000000\n"
      "RLASER 3 1.50 1.25 1.00 -0.200000 0.000000 3.141593 0.000000 0.000000 0.000000 1127233281.000000 "
      "robot "
      "1.100000\n"
      "RAWLASER3 0 -1.570796 3.141593 1.570796 80.000000 0.010000 1 3 1.000 2.500 3.000 3 11.000000 "
      "12.000000 "
      "13.000000 1127233281.500000 robot 1.500000\n"
      "RAWLASER4 0 -1.570796 3.141593 1.570796 80.000000 0.010000 3 1.00 2.50 3.00 0 1127233281.500000 robot "
      "1.500000\n"
      "SONAR 0.261799 2 1.50 0.75 0.100 0.200 1.570796 0.100 -0.200 -1.570796 1127233281.600000 robot "
      "1.600000\n"
      "TRUEPOS 0.010000 0.000000 0.000000 0.000000 0.000000 0.000000 1127233281.000000 robot 1.700000\n"
      "ODOM 0.200000 0.000000 0.000000 0.100000 0.000000 0.000000 1127233282.000000 robot 2.000000\n");
  EXPECT_TRUE(report.skipped.empty());
  EXPECT_EQ(report.scans, 5);
  EXPECT_EQ(Beams("laser"), 3);
  EXPECT_EQ(Column<double>("robot/0/laser/range_m")[1], 2.5);
  EXPECT_TRUE(std::isnan(Column<double>("robot/0/laser/range_m")[2]));
  EXPECT_NEAR(Column<double>("robot/0/laser/beam_x_m")[0], 0.25, 1e-9);
  EXPECT_NEAR(Column<double>("robot/0/laser2/beam_x_m")[0], -0.2, 1e-9);
  EXPECT_EQ(Column<double>("robot/0/laser2/range_m")[1], 1.25);
  for (const char* sensor : {"laser3", "laser4"}) {
    const auto range = Column<double>(std::string("robot/0/") + sensor + "/range_m");
    EXPECT_EQ(std::vector<double>(range.begin(), range.end()), (std::vector<double>{1, 2.5, 3})) << sensor;
  }
  EXPECT_EQ(Column<float>("robot/0/laser3/intensity"), (std::vector<float>{11, 12, 13}));
  for (const char* sensor : {"laser", "laser2", "laser4", "sonar"})
    EXPECT_FALSE(log_.Has(std::string("robot/0/") + sensor + "/intensity")) << sensor;
  EXPECT_EQ(Column<double>("robot/0/sonar/range_m")[1], 0.75);
  EXPECT_EQ(Column<double>("robot/0/sonar/beam_y_m")[1], -0.2);
  EXPECT_EQ(Column<double>("robot/0/laser/time_s")[0], 1127233281.0);
  EXPECT_EQ(Column<double>("truth/robot/0/poses/x_m"), (std::vector<double>{0.01}));
}

// No public program was found that writes MARKER; its form is that of CARMEN's other messages of text.
TEST_F(ImportCarmenTest, MarkersAreContactsWithAndWithoutNames) {
  const std::string log =
      "ODOM 0 0 0 0 0 0 1 h 1\nMARKER big door 1.5 h 1.5\nMARKER 2 h 2\nMARKER big door 3 h 3\nMARKER ? 3.5 "
      "h "
      "3.5\n"
      "ODOM 1 0 0 0 0 0 4 h 4\n";
  EXPECT_EQ(Import(log).contacts, 4);
  EXPECT_EQ(Column<std::int32_t>("robot/0/observations/landmark"),
            (std::vector<std::int32_t>{-1, -1, -1, -1}));
  options_.named_markers = true;
  EXPECT_EQ(Import(log).landmarks, 1);
  EXPECT_EQ(Column<std::int32_t>("robot/0/observations/landmark"), (std::vector<std::int32_t>{0, -1, 0, -1}))
      << "no text and '?' are no names";
  EXPECT_EQ(log_.Texts("landmarks")[0], "big door");
}

TEST_F(ImportCarmenTest, StampsThatTellNothingApartGiveWayToNumbers) {
  std::string log = "NEFF 1\n";
  for (int i = 0; i < 5; ++i)
    log += Flaser(std::to_string(i) + " 0 0", std::to_string(i) + " 0 0", "1.01893e+09") +
           "ODOM 9 0 0 0 0 0 0 p 0\n";
  const ImportReport report = Import(log);
  EXPECT_EQ(Column<double>("robot/0/laser/time_s"), (std::vector<double>{0, 2, 4, 6, 8}));
  EXPECT_EQ(Column<double>("robot/0/poses/time_s").size(), 10U);
  EXPECT_TRUE(std::ranges::any_of(report.warnings, [](const std::string& w) {
    return w.find("time is the line's number") != std::string::npos;
  }));
}

TEST_F(ImportCarmenTest, AScanWithoutAResolutionOrAMaximumAboveZeroIsABadLine) {
  const auto log = [](const std::string& step, const std::string& max) {
    std::string text;
    for (const std::string n : {"1", "2"}) {
      text +=
          "ODOM " + n + " 0 0 0 0 0 " + n + " h " + n + "\n" + "RAWLASER1 0 -1 2 " + (n == "2" ? step : "1");
      text += " " + (n == "2" ? max : "9") + " 0.01 0 3 1 2 3 0 " + n + " h " + n + "\n";
    }
    return text;
  };
  for (const std::string value : {"0", "-0.5"}) {
    ExpectContains(Refusal(log(value, "9")), "log.log:4: no angular resolution: field 5 is '" + value + "'");
    ExpectContains(Refusal(log("1", value)), "log.log:4: no maximum range: field 6 is '" + value + "'");
  }
  options_.skip_bad = true;
  const ImportReport report = Import(log("1", "-9"));
  EXPECT_EQ(report.skipped.at("no maximum range"), 1);
  EXPECT_EQ(report.scans, 1);
}

TEST_F(ImportCarmenTest, BadLinesAreNamedWithTheirFileAndLine) {
  const std::string odometry = "ODOM 0 0 0 0 0 0 1 h 1\n";
  ExpectContains(Refusal(odometry + "BOGUS 1 2\n"), "log.log:2: unknown message: 'BOGUS'");
  ExpectContains(Refusal(odometry + "ODOM 1 2 3\n"), "log.log:2: line cut short");
  ExpectContains(Refusal(odometry + "FLASER 180" + Many(179, "2") + " 0 0 0 0 0 0 2 h 2\n"),
                 "log.log:2: line cut short, or fewer values than it declares: 180 readings take 191 fields, "
                 "there are 190");
  ExpectContains(Refusal(odometry + "FLASER 2 1 1 1 0 0 0 0 0 0 2 h 2 3\n"),
                 "more values than the line declares");
  ExpectContains(Refusal(odometry + "FLASER 2 1 nan 0 0 0 0 0 0 2 h 2\n"),
                 "log.log:2: range is not finite: beam 1 measures nan");
  ExpectContains(Refusal(odometry + "FLASER 2 inf 1 0 0 0 0 0 0 2 h 2\n"),
                 "log.log:2: range is not finite: beam 0 measures inf");
  ExpectContains(Refusal(odometry + "FLASER 2 1 -1 0 0 0 0 0 0 2 h 2\n"),
                 "negative range: beam 1 measures -1");
  ExpectContains(Refusal(odometry + "FLASER 2 1 5000 0 0 0 0 0 0 2 h 2\n"), "beyond any sensor's reach");
  ExpectContains(Refusal(odometry + "FLASER 2.5 1 1 0 0 0 0 0 0 2 h 2\n"), "no count");
  ExpectContains(Refusal(odometry + "FLASER 1e300 1 1 0 0 0 0 0 0 2 h 2\n"), "no count");
  ExpectContains(Refusal(odometry + "SONAR 0.2 2 1 1 0 0 0 2 h 2\n"), "log.log:2: line cut short");
  ExpectContains(Refusal(odometry + Flaser("0 0 0", "0 0 0", "5") + "FLASER 1 1 0 0 0 0 0 0 6 h 6\n"),
                 "log.log:3: other beams than the sensor's first scan: 1 instead of 180");
  ExpectContains(Refusal(odometry + Flaser("0 0 0", "0 0 0", "5") + Flaser("0 0 0", "0 0 0", "3")),
                 "log.log:3: time runs backwards: 3.0");
  ExpectContains(Refusal("# nothing\n"), "neither odometry nor a pose");
  options_.skip_bad = true;
  const ImportReport report = Import(odometry + "BOGUS\nFLASER 2 1 nan 0 0 0 0 0 0 2 h 2\n" +
                                     Flaser("0 0 0", "0 0 0", "5") + Flaser("0 0 0", "0 0 0", "3"));
  EXPECT_EQ(report.skipped,
            (std::map<std::string, std::int64_t>{
                {"range is not finite", 1}, {"time runs backwards", 1}, {"unknown message", 1}}));
  EXPECT_EQ(report.scans, 1);
}

TEST_F(ImportCarmenTest, BeamsAreSpacedByParamByOptionOrByTheirNumber) {
  const auto fan = [&](int beams, const std::string& param) {
    Import(param + "FLASER " + std::to_string(beams) + Many(beams, "1") + " 0 0 0 0 0 0 1 h 1\n");
    const auto heading = Column<double>("robot/0/laser/beam_heading_rad");
    return std::pair(heading[0] * 180 / kPi, (heading[1] - heading[0]) * 180 / kPi);
  };
  const auto expect = [](std::pair<double, double> got, double first, double step) {
    EXPECT_NEAR(got.first, first, 1e-9);
    EXPECT_NEAR(got.second, step, 1e-9);
  };
  expect(fan(180, ""), -90, 1);
  expect(fan(181, ""), -90, 1);
  expect(fan(360, ""), -90, 0.5);
  expect(fan(361, ""), -90, 0.5);
  expect(fan(401, ""), -50, 0.25);
  expect(fan(91, ""), -90, 2);
  expect(fan(101, "PARAM laser_frontlaser_resolution 1 0 h 0\n"), -50, 1);
  options_.first_deg = -120;
  options_.step_deg = 3;
  expect(fan(180, ""), -120, 3);
}

// What the recordings' makers say of them, and what their READMEs counted.
TEST(ImportCarmenData, HoldsWhatIsKnownOfIt) {
  if (DataFolder().empty()) GTEST_SKIP() << "CAIRN_DATA is not set (docs/datasets.md)";
  const struct {
    const char* file;
    std::int64_t scans, beams, silent;
    double travelled_m;
  } logs[] = {{"carmen-intel/intel-corrected.log.gz", 910, 180, 4172, 499.5},
              {"carmen-fr079/freiburg-079-corrected.log.gz", 4791, 360, 36004, 422.5},
              {"carmen-belgioioso/belgioioso-corrected.log.gz", 395, 361, 699, 219.0},
              {"carmen-fhw-museum/fhw-corrected.log.gz", 488, 180, 647, 405.5}};
  for (const auto& expected : logs) {
    SCOPED_TRACE(expected.file);
    CarmenImportOptions options;
    options.path = DataFolder() + "/" + expected.file;
    Blob log;
    const ImportReport report = ImportCarmen(options, &log);
    EXPECT_EQ(report.scans, expected.scans);
    EXPECT_EQ(log.at("robot/0/laser/range_m").shape(), (Shape{expected.scans, expected.beams}));
    EXPECT_EQ(report.read.at("readings of laser without an answer within its reach"), expected.silent);
    const Track track = ReadTrack(log, "robot/0/poses/");
    EXPECT_EQ(std::ranges::adjacent_find(track.time_s, std::ranges::greater_equal()), track.time_s.end());
    double travelled_m = 0;
    std::optional<Pose> before;
    for (const double time : log.Get<double>("robot/0/laser/time_s")) {
      const auto found = std::ranges::lower_bound(track.time_s, time);
      ASSERT_TRUE(found != track.time_s.end() && *found == time) << "each scan has a row of its own";
      const Pose pose = track.poses[static_cast<std::size_t>(found - track.time_s.begin())];
      if (before) travelled_m += std::hypot(pose.x_m - before->x_m, pose.y_m - before->y_m);
      before = pose;
    }
    EXPECT_NEAR(travelled_m, expected.travelled_m, 0.5);
  }
}

// The raw log and the corrected one are of the same scans; the corrected poses are those that stand beside
// them.
TEST(ImportCarmenData, RawAndCorrectedIntelLogsAgree) {
  if (DataFolder().empty()) GTEST_SKIP() << "CAIRN_DATA is not set (docs/datasets.md)";
  CarmenImportOptions options;
  Blob raw, corrected;
  options.path = DataFolder() + "/carmen-intel/intel-raw.log.gz";
  ImportCarmen(options, &raw);
  EXPECT_FALSE(raw.Has("robot/0/poses/time_s"));
  options.path = DataFolder() + "/carmen-intel/intel-corrected.log.gz";
  ImportCarmen(options, &corrected);
  double travelled_m = 0;
  for (const double forward : raw.Get<double>("robot/0/odometry/forward_m")) travelled_m += std::abs(forward);
  EXPECT_NEAR(travelled_m, 501.1, 0.5);
  const Pose end = ReadTrajectory(raw, "").poses.back();
  EXPECT_NEAR(end.x_m, -29.9, 0.05) << "as seen from the first scan, so its README";
  EXPECT_NEAR(end.y_m, -55.1, 0.05);
  const auto a = raw.Get<double>("robot/0/laser/range_m"), b = corrected.Get<double>("robot/0/laser/range_m");
  ASSERT_EQ(a.size(), b.size());
  std::size_t equal = 0;  // four scans stand in another order there
  for (std::size_t i = 0; i < a.size(); ++i) equal += a[i] == b[i] || (std::isnan(a[i]) && std::isnan(b[i]));
  EXPECT_GT(equal, a.size() * 98 / 100);
}

}  // namespace
}  // namespace cairn::datasets
