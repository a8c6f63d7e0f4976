#include "datasets/common/unit_doubts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "datasets/common/text_file.h"
#include "datasets/import/csv.h"
#include "datasets/import/recorded/carmen.h"
#include "datasets/import/recorded/mrclam.h"
#include "datasets/import/recorded/ranges.h"
#include "datasets/import/recorded/recorded.h"
#include "datasets/import/trajectories.h"
#include "datasets/import/vectors.h"
#include "datasets/simulate/hall/hall.h"
#include "datasets/simulate/loop.h"
#include "datasets/simulate/office/office.h"
#include "datasets/testing.h"

namespace cairn::datasets {
namespace {

constexpr double kUnitDegree_rad = std::numbers::pi / 180;

std::string Only(const ImportReport& report) {
  EXPECT_EQ(report.unit_doubts.size(), 1U);
  return report.unit_doubts.empty() ? "" : report.unit_doubts.front();
}

// A robot that drives squares of 3 m at 0.3 m/s and turns by 45 degrees a second, a row each 0.1 s, sees a
// pole every second; written in other units: `way`, `turn`, `time`, `bearing` of them make one of Cairn's.
struct Units {
  double distance = 1, turn = 1, time = 1, bearing = 1, range = 1;
};

class UnitsOfFiles : public ImportTest {
 protected:
  struct Row {
    double time_s = 0, turn_rad = 0, forward_m = 0, x_m = 0, y_m = 0, heading_rad = 0;
  };

  static std::vector<Row> Square() {
    std::vector<Row> rows;
    Row at;
    for (int side = 0; side < 8; ++side) {
      for (int i = 0; i < 120; ++i) {
        const bool turns = i >= 100;
        at.time_s += 0.1;
        at.turn_rad = turns ? 4.5 * kUnitDegree_rad : 0;
        at.forward_m = turns ? 0 : 0.03;
        at.heading_rad = std::remainder(at.heading_rad + at.turn_rad, 2 * std::numbers::pi);
        at.x_m += at.forward_m * std::cos(at.heading_rad);
        at.y_m += at.forward_m * std::sin(at.heading_rad);
        rows.push_back(at);
      }
    }
    return rows;
  }

  static std::string Line(const std::vector<double>& values, const char* between) {
    std::string line;
    for (const double value : values) {
      char text[32];
      std::snprintf(text, sizeof text, "%.6f", value);
      line += (line.empty() ? "" : between) + std::string(text);
    }
    return line + "\n";
  }

  ImportReport Csv(const Units& units) {
    std::string odometry = "time_s,turn_rad,forward_m\n", seen = "time_s,landmark,range_m,bearing_rad\n";
    const std::vector<Row> rows = Square();
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double time = units.time * rows[i].time_s;
      odometry += Line({time, units.turn * rows[i].turn_rad, units.distance * rows[i].forward_m}, ",");
      const double bearing = std::remainder(-rows[i].heading_rad, 2 * std::numbers::pi);
      if (i % 10 == 0)
        seen += Line({time}, ",").substr(0, Line({time}, ",").size() - 1) + ",," +
                Line({units.range * 2.5, units.bearing * bearing}, ",");
    }
    CsvImportOptions options;
    options.odometry = folder_.Put("odometry.csv", odometry);
    options.observations = folder_.Put("observations.csv", seen);
    return ImportCsv(options, &log_);
  }

  ImportReport Mrclam(const Units& units) {
    folder_.Put("Barcodes.dat", "1 5\n6 63\n");
    std::string odometry, seen;
    for (const Row& row : Square()) {
      odometry +=
          Line({units.time * row.time_s, 10 * units.distance * row.forward_m, 10 * units.turn * row.turn_rad},
               " ");
      seen += Line({units.time * row.time_s, 63, 2, units.bearing * 0.5 * std::sin(row.time_s)}, " ");
    }
    folder_.Put("Robot1_Odometry.dat", odometry);
    folder_.Put("Robot1_Measurement.dat", seen);
    MrclamImportOptions options;
    options.folder = folder_ / "";
    options.noise.field_of_view_rad = 6.28;
    return ImportMrclam(options, &log_);
  }

  ImportReport Tum(const Units& units) {
    std::string poses;
    for (const Row& row : Square())
      poses += Line({units.time * row.time_s, units.distance * row.x_m, units.distance * row.y_m,
                     units.turn * row.heading_rad},
                    " ");
    return ImportTrajectories({{folder_.Put("track.txt", poses)}, {}, false}, &log_);
  }

  ImportReport Vectors(const Units& units) {
    std::string text = "time_s,x_m,y_m,heading_rad,sonar\n";
    for (const Row& row : Square())
      text += Line({units.time * row.time_s, units.distance * row.x_m, units.distance * row.y_m,
                    units.turn * row.heading_rad, 1},
                   ",");
    VectorsImportOptions options;
    options.runs = {folder_.Put("run.csv", text)};
    return ImportVectors(options, &log_);
  }

  ImportReport Carmen(const Units& units) {
    std::string text;
    for (const Row& row : Square())
      text += "ODOM " + Line({units.distance * row.x_m, units.distance * row.y_m,
                              units.turn * row.heading_rad, 0, 0, 0},
                             " ");
    std::string lines;
    std::size_t i = 0;
    const std::vector<Row> rows = Square();
    for (std::size_t begin = 0, end = 0; (end = text.find('\n', begin)) != text.npos; begin = end + 1, ++i)
      lines += text.substr(begin, end - begin) + " " + std::to_string(units.time * rows[i].time_s) + " h 1\n";
    CarmenImportOptions options;
    options.path = folder_.Put("log.log", lines);
    return ImportCarmen(options, &log_);
  }
};

TEST_F(UnitsOfFiles, WhatARobotDoesIsNotInDoubt) {
  EXPECT_TRUE(Csv({}).unit_doubts.empty());
  EXPECT_TRUE(Mrclam({}).unit_doubts.empty());
  EXPECT_TRUE(Tum({}).unit_doubts.empty());
  EXPECT_TRUE(Vectors({}).unit_doubts.empty());
  EXPECT_TRUE(Carmen({}).unit_doubts.empty());
}

TEST_F(UnitsOfFiles, BearingsInDegreesAreNamedWithTheirLine) {
  const std::string csv = Only(Csv({.bearing = 1 / kUnitDegree_rad}));
  ExpectContains(csv, "observations.csv:");
  ExpectContains(csv, "robot 'robot', row ");
  ExpectContains(csv, "bearings reach -1");
  ExpectContains(csv, "are they in degrees? Cairn reads radians");
  ExpectContains(InputErrorOf([this] { Mrclam({.bearing = 1 / kUnitDegree_rad}); }),
                 "rad to either side: are bearings in degrees? Cairn reads radians");
}

TEST_F(UnitsOfFiles, WaysInMillimetresAreNamedWithTheirLine) {
  const std::string csv = Only(Csv({.distance = 1000}));
  ExpectContains(csv, "odometry.csv:");
  ExpectContains(
      csv, "which is 300 m/s; no robot is believed to do more than 60 m/s: are distances in millimetres?");
  ExpectContains(Only(Mrclam({.distance = 1000})), "Robot1_Odometry.dat:");
  ExpectContains(Only(Tum({.distance = 1000})), "track.txt:");
  ExpectContains(Only(Vectors({.distance = 1000})), "are positions in millimetres?");
  ExpectContains(Only(Carmen({.distance = 1000})), "in millimetres?");
}

TEST_F(UnitsOfFiles, WaysThatNobodyDrivesOnAverageAreInDoubt) {
  ExpectContains(Only(Csv({.distance = 150})), "is much: are distances in centimetres?");
  ExpectContains(Only(Csv({.distance = 1e-3})),
                 "it does 0.3 mm/s in the mean: are distances in metres, under a header that says _mm?");
}

TEST_F(UnitsOfFiles, TurnsAndHeadingsInDegreesAreNamedWithTheirLine) {
  ExpectContains(Only(Csv({.turn = 1 / kUnitDegree_rad})), "odometry.csv:");
  ExpectContains(Only(Csv({.turn = 1 / kUnitDegree_rad})),
                 "it turns by 22.5 rad within 0.5 s, which is 45 rad/s");
  ExpectContains(Only(Mrclam({.turn = 1 / kUnitDegree_rad})), "are turns in degrees?");
  ExpectContains(Only(Tum({.turn = 1 / kUnitDegree_rad})), "are headings in degrees?");
  ExpectContains(Only(Vectors({.turn = 1 / kUnitDegree_rad})), "are headings in degrees?");
  ExpectContains(Only(Vectors({.turn = 1 / kUnitDegree_rad})), ".csv: run '");
}

TEST_F(UnitsOfFiles, TimesInMillisecondsAreSeenByHowSlowItIs) {
  ExpectContains(Only(Csv({.time = 1000})), "mm/s: are times in milliseconds? Cairn reads seconds");
  ExpectContains(Only(Tum({.time = 1000})), "are times in milliseconds?");
  ExpectContains(Only(Vectors({.time = 1000})), "are times in milliseconds?");
  ExpectContains(Only(Carmen({.time = 1000})), "are times in milliseconds?");
  const std::vector<double> unix_ms = {1.7e12, 1.7e12 + 100}, zeros = {0, 0};
  ExpectContains(DoubtControls(unix_ms, zeros, zeros)->text,
                 "beyond the year 2103: are times in milliseconds?");
  ExpectContains(Only(Csv({.time = 1e6})), "are times in microseconds?");
  ExpectContains(Only(Csv({.time = 1e6})), "where it says one already, they may be smaller still");
}

TEST_F(UnitsOfFiles, RangesInMillimetresAreNamedUnlessTheSensorIsKnown) {
  ExpectContains(Only(Csv({.range = 1000})), "ranges reach 2500: are they in millimetres?");
  ExpectContains(Only(Csv({.range = 200})), "ranges reach 500: are they in centimetres?");
  const std::vector<double> time = {1}, range = {2500}, bearing = {0};
  EXPECT_FALSE(DoubtObservations(time, range, bearing, true));
}

// A robot that goes around circles, its poses as odometry.csv has them.
class HeadingsOfFiles : public ImportTest {
 protected:
  // `heading`: of the angle at which it goes.
  template <class Heading>
  std::vector<std::string> DoubtsWith(const Heading& heading, bool swapped = false) {
    std::string odometry = "time_s,x_m,y_m,heading_rad\n";
    for (int i = 0; i < 800; ++i) {
      const double angle = 0.02 * i, x = 3 * std::sin(angle), y = 3 - 3 * std::cos(angle);
      char line[128];
      std::snprintf(line, sizeof line, "%.1f,%.4f,%.4f,%.4f\n", 0.1 * i, swapped ? y : x, swapped ? x : y,
                    std::remainder(heading(angle), 2 * std::numbers::pi));
      odometry += line;
    }
    CsvImportOptions options;
    options.odometry = folder_.Put("odometry.csv", odometry);
    const std::vector<std::string> at_import = ImportCsv(options, &log_).unit_doubts;
    EXPECT_EQ(FindUnitDoubts(log_).size(), at_import.size()) << "inspect, run and submit ask as import does";
    return at_import;
  }
};

TEST_F(HeadingsOfFiles, OfARobotThatGoesWhereTheyPointAreNotInDoubt) {
  EXPECT_TRUE(DoubtsWith([](double angle) { return angle; }).empty());
  EXPECT_TRUE(DoubtsWith([](double angle) { return angle + std::numbers::pi; }).empty()) << "backwards";
}

TEST_F(HeadingsOfFiles, ThatDoNotFitTheWayAreAskedFor) {
  const auto ask = [](const std::vector<std::string>& doubts, const std::string& question) {
    ASSERT_EQ(doubts.size(), 1U);
    ExpectContains(doubts.front(), "robot 'robot', row 1 of its odometry (0 s): it does not go where");
    ExpectContains(doubts.front(), question);
  };
  constexpr double kQuarter = std::numbers::pi / 2;
  ask(DoubtsWith([](double angle) { return kQuarter - angle; }), "are headings a compass's, clockwise");
  ask(DoubtsWith([](double angle) { return angle; }, true), "or are x and y exchanged?");
  ask(DoubtsWith([](double angle) { return -angle; }), "do headings grow clockwise");
  ask(DoubtsWith([](double angle) { return angle - kQuarter; }), "do headings begin at the y axis?");
  ask(DoubtsWith([](double angle) { return 3 * angle; }), "in degrees?");
}

// 1.2 degrees a second, written as radians: no turn is too fast.
TEST(UnitDoubts, HeadingsInDegreesOfASlowRobotAreInDoubt) {
  std::vector<double> time, x, zero, degrees, around;
  for (int i = 0; i < 300; ++i) {
    time.push_back(0.25 * i);
    x.push_back(0.1 * i);
    zero.push_back(0);
    degrees.push_back(0.3 * i);
    around.push_back(4 * std::numbers::pi);
  }
  const auto doubt = DoubtPoses(time, x, zero, degrees);
  ASSERT_TRUE(doubt);
  EXPECT_EQ(doubt->row, 299U);
  ExpectContains(doubt->text,
                 "headings reach 89.7, and it does not go where they point: are they in degrees?");
  EXPECT_FALSE(DoubtPoses(time, x, zero, around));
}

TEST(UnitDoubts, BearingsInRadiansUnderAHeaderThatSaysDegreesAreInDoubt) {
  std::vector<double> time, range, narrow, radians;
  for (int i = 0; i < 30; ++i) {
    time.push_back(i);
    range.push_back(3);
    narrow.push_back(0.001 * (i % 3));                // of a sensor that looks straight ahead
    radians.push_back((0.1 * i - 1.5) / 180 * M_PI);  // -1.5 to 1.4 rad, taken for degrees
  }
  const auto doubt = DoubtObservations(time, range, radians, true);
  ASSERT_TRUE(doubt);
  EXPECT_EQ(doubt->row, 0U);
  ExpectContains(doubt->text, "are they in radians, under a header that says _deg?");
  EXPECT_FALSE(DoubtObservations(time, range, narrow, true));
  radians.back() = 0.06;
  EXPECT_FALSE(DoubtObservations(time, range, radians, true)) << "one is more than a half turn would be";
  radians.resize(10);
  EXPECT_FALSE(DoubtObservations(std::span<const double>(time).first(10),
                                 std::span<const double>(range).first(10), radians, true));
}

TEST(UnitDoubts, ObservationsThatAllComeInTheFirstMomentAreInDoubt) {
  std::vector<double> odometry, seconds_as_ms, early;
  for (int i = 0; i <= 600; ++i) odometry.push_back(100 + i);
  for (int i = 0; i < 30; ++i) {
    seconds_as_ms.push_back(100 + 0.02 * i);
    early.push_back(100 + 0.2 * i);
  }
  const auto doubt = DoubtClock(odometry, seconds_as_ms);
  ASSERT_TRUE(doubt);
  EXPECT_EQ(doubt->row, 29U);
  ExpectContains(doubt->text, "within the first 0.58 s of 600 s of odometry");
  EXPECT_FALSE(DoubtClock(odometry, early));
  EXPECT_FALSE(DoubtClock(odometry, std::span<const double>(seconds_as_ms).first(10)));
  EXPECT_FALSE(DoubtClock({}, seconds_as_ms));
}

TEST(UnitDoubts, TurnsOfTwoRadiansInATenthOfASecondAreInDoubtAndInASecondTheyAreNot) {
  std::vector<double> fast = {0}, slow = {0}, turn = {0}, zero = {0};
  for (int i = 1; i < 10; ++i) {
    fast.push_back(0.1 * i);
    slow.push_back(1.0 * i);
    turn.push_back(2);
    zero.push_back(0);
  }
  const auto doubt = DoubtControls(fast, turn, zero);
  ASSERT_TRUE(doubt);
  ExpectContains(doubt->text, "it turns by 10 rad within 0.5 s, which is 20 rad/s");
  EXPECT_FALSE(DoubtControls(slow, turn, zero));
}

TEST(UnitDoubts, OneOddRowThatIsTakenBackIsNoMistakeOfUnits) {
  EXPECT_FALSE(DoubtControls(std::vector{0.0, 0.1, 0.2, 0.3}, std::vector{0.0, 2.0, -2.0, 0.1},
                             std::vector{0.0, 0.0, 0.0, 0.1}));
}

TEST(UnitDoubts, ManyRowsOfOneMomentAreOneMove) {  // a log whose messages waited
  EXPECT_FALSE(DoubtControls(std::vector{0.0, 1.0, 1.0, 1.001}, std::vector{0.0, 0.3, 0.3, 0.3},
                             std::vector{0.0, 0.5, 0.5, 0.5}));
}

TEST(UnitDoubts, AHeadingThatGoesOnBeyondAFullTurnIsNotInDoubt) {
  std::vector<double> time, zero, heading;
  for (int i = 0; i < 400; ++i) {
    time.push_back(0.1 * i);
    zero.push_back(0);
    heading.push_back(0.1 * i);  // 6 turns
  }
  EXPECT_FALSE(DoubtPoses(time, zero, zero, heading));
}

// Of odometry that counts full turns, and begins anew where somebody restarts it.
TEST(UnitDoubts, AHeadingThatIsSetBackBySeveralTurnsIsNotInDoubtWhereItPointsAhead) {
  std::vector<double> time, x, y, heading, degrees, zero;
  for (int i = 0; i < 900; ++i) {
    const double turned = 0.05 * i;  // circles of a metre: 7 turns
    time.push_back(0.1 * i);
    x.push_back(std::sin(turned));
    y.push_back(1 - std::cos(turned));
    heading.push_back(i < 700 ? turned : turned - 10 * std::numbers::pi);
    degrees.push_back(std::remainder(turned, 2 * std::numbers::pi) / kUnitDegree_rad);
    zero.push_back(0);
  }
  EXPECT_FALSE(DoubtPoses(time, x, y, heading));
  const auto standing = DoubtPoses(time, zero, zero, heading);
  ASSERT_TRUE(standing) << "nothing tells whether they are radians";
  ExpectContains(standing->text, "it turns by 24.88 rad within 0.5 s");
  const auto doubt = DoubtPoses(time, x, y, degrees);
  ASSERT_TRUE(doubt);
  ExpectContains(doubt->text, "are headings in degrees?");
}

TEST(UnitDoubts, AFastCarIsNotInDoubt) {
  std::vector<double> time, turn, forward;
  for (int i = 0; i < 400; ++i) {
    time.push_back(0.025 * i);
    turn.push_back(0.025 * 0.8);
    forward.push_back(0.025 * 50);  // 180 km/h
  }
  EXPECT_FALSE(DoubtControls(time, turn, forward));
}

TEST(UnitDoubts, WhoInsistsIsNotAskedAgain) {
  Blob log;
  log.Put("robots", Array::Texts({"a"}));
  log.PutVector("robot/0/odometry/time_s", std::vector{0.0, 1.0});
  log.PutVector("robot/0/odometry/turn_rad", std::vector{0.0, 0.0});
  log.PutVector("robot/0/odometry/forward_m", std::vector{0.0, 500.0});
  ASSERT_EQ(FindUnitDoubts(log).size(), 1U);
  ExpectContains(FindUnitDoubts(log).front(),
                 "robot 'a', row 2 of its odometry (1 s): it goes 500 m within 1 s");
  NoteUnitsAreRight(&log);
  EXPECT_TRUE(FindUnitDoubts(log).empty());
}

TEST(UnitDoubts, NoSimulatedLogIsInDoubt) {
  for (const LoopDifficulty& difficulty : LoopDifficulties()) {
    SimulateLoopOptions options;
    options.difficulty = difficulty.name;
    options.seed = 7;
    const std::vector<std::string> doubts = FindUnitDoubts(SimulateLoop(options));
    EXPECT_TRUE(doubts.empty()) << difficulty.name << ": " << doubts.front();
  }
  const auto expect_none = [](const Blob& log) {
    const std::vector<std::string> doubts = FindUnitDoubts(log);
    EXPECT_TRUE(doubts.empty()) << doubts.front();
  };
  expect_none(SimulateHallway({}));
  expect_none(SimulateNarrowDoors(1));
  expect_none(SimulateSmoothWall(1));
  expect_none(SimulateOffice({}));
}

// The recorded logs that there are, whole.
TEST(UnitDoubts, NoRecordedLogIsInDoubt) {
  const std::string data = DataFolder();
  if (data.empty()) GTEST_SKIP() << "CAIRN_DATA is not set";
  Blob log;
  const auto expect_none = [&](const std::string& name, const ImportReport& report) {
    EXPECT_TRUE(report.unit_doubts.empty()) << name << ": " << report.unit_doubts.front();
    EXPECT_TRUE(FindUnitDoubts(log).empty()) << name << ": " << FindUnitDoubts(log).front();
  };
  for (const char* name : {"mrclam1", "mrclam6", "mrclam9"}) {
    MrclamImportOptions options;
    options.folder = data + "/" + name;
    options.skip_bad = true;
    expect_none(name, ImportMrclam(options, &log));
  }
  RecordedImportOptions park;
  park.folder = data + "/victoria-park";
  expect_none("victoria-park", ImportVictoriaPark(park, &log));
  RecordedImportOptions lego;
  lego.folder = data + "/lego-robot";
  expect_none("lego-robot", ImportLegoRobot(lego, &log));
  for (const char* name :
       {"carmen-intel/intel-corrected.log.gz", "carmen-intel/intel-raw.log.gz",
        "carmen-fr079/freiburg-079-corrected.log.gz", "carmen-fhw-museum/fhw-corrected.log.gz",
        "carmen-belgioioso/belgioioso-corrected.log.gz"}) {
    CarmenImportOptions options;
    options.path = data + "/" + name;
    options.skip_bad = true;
    expect_none(name, ImportCarmen(options, &log));
  }
  RangeImportOptions range;
  range.skip_bad = true;
  for (const char* run : {"run1", "run2", "run4"}) {
    range.path = data + "/pioneer-sonar-laser/" + run;
    expect_none(run, ImportPioneer(range, &log));
  }
  range.path = data + "/dpslam-loop5/loop5.log.gz";
  expect_none("loop5", ImportDpSlam(range, &log));
  for (const char* name : {"robotdata1", "robotdata2", "robotdata3"}) {
    range.path = data + "/wean-hall/" + name + ".log.gz";
    expect_none(name, ImportWean(range, &log));
  }
  for (const auto& entry : std::filesystem::directory_iterator(data + "/loops-csv")) {
    if (!entry.is_directory()) continue;
    CsvImportOptions options;
    options.odometry = FindFile(entry.path().string(), "odometry.csv");
    options.observations = FindFile(entry.path().string(), "observations.csv");
    options.truth_poses = FindFile(entry.path().string(), "truth_poses.csv");
    expect_none(entry.path().string(), ImportCsv(options, &log));
  }
}

}  // namespace
}  // namespace cairn::datasets
