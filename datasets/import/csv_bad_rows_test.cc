// Rows that cannot be taken: which row it is and why, and what is lost where they are skipped.
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "datasets/import/testing_csv.h"

namespace cairn::datasets {
namespace {

TEST_F(ImportCsvTest, BadOdometryNamesFileLineAndReason) {
  const auto failure = [&](const std::string& rows) {
    options_.odometry = folder_.Put("o.csv", "time_s,robot,turn_rad,forward_m\n" + rows);
    return Failure();
  };
  ExpectContains(failure("1,a,0,x\n"), "o.csv:2: not a number: forward_m is 'x'");
  ExpectContains(failure("1,a,0,1\n2,a,nan,1\n"), "o.csv:3: not finite: turn_rad is 'nan'");
  ExpectContains(failure("1,a,0,1\n2,b,0,1\n1.5,b,0,1\n"),
                 "o.csv:4: time runs backwards: 1.500000 after 2.000000");
  ExpectContains(failure("1,,0,1\n"), "o.csv:2: unknown robot");
}

TEST_F(ImportCsvTest, BadObservationsNameFileLineAndReason) {
  options_.noise.max_range_m = 5;
  options_.truth_landmarks = folder_.Put("landmarks.csv", "landmark,x_m,y_m\ndoor,1,2\n");
  const auto failure = [&](const std::string& rows) {
    PutObservations(rows);
    return Failure();
  };
  ExpectContains(failure("1,Rosa,,,\n1,Hugo,,,\n"),
                 "observations.csv:3: unknown robot: 'Hugo' has no odometry");
  ExpectContains(failure("1,Rosa,wall,,\n"), "observations.csv: unknown landmark: 'wall'");
  ExpectContains(failure("0.5,Rosa,,,\n"),
                 "observations.csv:2: before the first control: 0.500000 before 1.000000");
  ExpectContains(failure("3.5,Rosa,,,\n"),
                 "observations.csv:2: after the last control: 3.500000 after 3.000000");
  ExpectContains(failure("3500,Rosa,,,\n"), "3500.000000 after 3.000000; is it in milliseconds?");
  ExpectContains(failure("2,Rosa,,,\n1,Rosa,,,\n"), "observations.csv:3: time runs backwards");
  ExpectContains(failure("2,Rosa,,-1,0\n"), "observations.csv:2: negative range: -1.000000 m");
  ExpectContains(failure("2,Rosa,,5.5,0\n"),
                 "observations.csv:2: beyond the sensor's maximum: 5.500000 m of 5.000000 m");
  options_.noise.field_of_view_rad = 2;
  ExpectContains(
      failure("2,Rosa,,5,-1.1\n"),
      "observations.csv:2: outside the sensor's field of view: -1.100000 rad, of at most 1.000000 rad");
  ExpectContains(failure("2,Rosa,,5,\n"), "observations.csv:2: range or bearing alone");
  ExpectContains(failure("2,Rosa,,,1\n"), "observations.csv:2: range or bearing alone");
  ExpectContains(failure("2,Rosa,,inf,1\n"), "observations.csv:2: not finite");
  ExpectContains(failure("2,Rosa\n"), "observations.csv:2: wrong number of columns");
}

// A sensor may be on while the robot still stands, before the first row of odometry.
TEST_F(ImportCsvTest, AnObservationBesideTheOdometryIsToldHowToBeTaken) {
  const std::string header = "time_s,robot,turn_rad,forward_m\n", rows = "1.5,Rosa,0,1\n2.7,Rosa,0,1\n";
  options_.odometry = folder_.Put("odometry.csv", header + rows);
  const char* remedy = "; a robot that stood still then needs a row of odometry that says so";
  PutObservations("2.9,Rosa,,,\n");
  ExpectContains(Failure(), std::string("after the last control: 2.900000 after 2.700000") + remedy);
  PutObservations("0.7,Rosa,,,\n");
  ExpectContains(Failure(), std::string("before the first control: 0.700000 before 1.500000") + remedy);
  options_.odometry = folder_.Put("odometry.csv", header + "0.7,Rosa,0,0\n" + rows);
  EXPECT_EQ(Import().observations, 1);
}

TEST_F(ImportCsvTest, NamesThatCanBeNoneAreBadLines) {
  const std::string long_name(257, 'x');
  PutObservations("1,Rosa,L\x1b[31m,1,0\n2,Rosa,a,1,0\n2,Rosa,a,2,0\n2,Rosa,a,3,0\n2,Rosa,\xff,1,0\n3,Rosa," +
                  long_name + ",1,0\n");
  ExpectContains(Failure(), "observations.csv:2: a name that has control characters: landmark is 'L");
  options_.skip_bad = true;
  const ImportReport report = Import();
  EXPECT_EQ(report.observations, 3);
  EXPECT_EQ(report.skipped.at("a name that is not UTF-8"), 1);
  EXPECT_EQ(report.skipped.at("a name that is longer than 256 bytes"), 1);
  options_.skip_bad = false;
  options_.odometry = folder_.Put("odometry.csv", "time_s,robot,turn_rad,forward_m\n1,a\x01,0,1\n");
  ExpectContains(Failure(), "odometry.csv:2: a name that has control characters: robot is 'a");
  options_.odometry = folder_.Put("odometry.csv", kOdometry);
  options_.truth_landmarks = folder_.Put("t.csv", "landmark,x_m,y_m\n\x7f,1,1\n");
  ExpectContains(Failure(), "t.csv:2: a name that has control characters");
}

TEST_F(ImportCsvTest, BadTruthNamesFileLineAndReason) {
  PutObservations("1,Rosa,,,\n");
  options_.truth_landmarks = folder_.Put("landmarks.csv", "landmark,x_m,y_m\na,1,2\n");
  const auto failure = [&](const std::string& rows) {
    options_.truth_associations = folder_.Put("associations.csv", "time_s,robot,landmark\n" + rows);
    return Failure();
  };
  ExpectContains(failure("2,Rosa,a\n"), "associations.csv:2: no such observation: of robot 'Rosa' at 2.0");
  ExpectContains(failure("1,Rosa,a\n1,Rosa,a\n"), "associations.csv:3: no such observation");
  ExpectContains(failure("1,Rosa,b\n"), "associations.csv:2: unknown landmark: 'b'");
  options_.truth_landmarks = folder_.Put("landmarks.csv", "landmark,x_m,y_m\na,1,2\na,1,2\n");
  ExpectContains(Failure(), "landmarks.csv:3: landmark without a name of its own: 'a'");
  options_.truth_landmarks = "";
  ExpectContains(Failure(), "associations need a file of true landmarks");
}

TEST_F(ImportCsvTest, SkipBadCountsByReasonAndKeepsTheRest) {
  options_.skip_bad = true;
  PutObservations(
      "0.5,Rosa,,,\n1,Rosa,,,\n0.9,Rosa,,,\nx,Rosa,,,\n1,Hugo,,,\n1,Rosa,,-1,0\n2,Rosa,,-2,0\n2,Rosa,,,\n"
      "2,Rosa,a,,\n2,Rosa,b,,\n3,Rosa,,,\n3,Rosa,a,,\n");
  const ImportReport report = Import();
  EXPECT_EQ(report.skipped, (std::map<std::string, std::int64_t>{{"before the first control", 1},
                                                                 {"negative range", 2},
                                                                 {"not a number", 1},
                                                                 {"time runs backwards", 1},
                                                                 {"unknown robot", 1}}));
  EXPECT_EQ(Column<double>("robot/0/observations/time_s"), (std::vector<double>{1, 2, 2, 2, 3, 3}));
}

std::string WarningsText(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

// A step that is left out shifts all that comes after it.
TEST_F(ImportCsvTest, SkippedRowsOfStepsLoseTheirMotionAndThatIsSaid) {
  options_.skip_bad = true;
  std::string rows;
  for (int i = 0; i < 20; ++i) rows += std::to_string(i) + ",a,0,1\n";
  const auto warnings = [&](const std::string& header, const std::string& bad) {
    options_.odometry = folder_.Put("o.csv", header + rows + bad);
    return WarningsText(Import().warnings);
  };
  const std::string steps = "time_s,robot,turn_rad,forward_m\n";
  ExpectContains(warnings(steps, "20,a,x,1\n"),
                 "o.csv: 1 row of odometry that tells motion is left out (line 22): what it told is lost; "
                 "the path after line 22 is off by it\n");
  ExpectContains(warnings(steps, "20,a,x,1\n3,a,0,1\n21,a,0,1\n22,a\n23,a,0,1\n"),
                 "o.csv: 3 rows of odometry that tell motion are left out (lines 22, 23, 25): what they told "
                 "is lost; the path after line 22 is off by it\n");
  ExpectContains(warnings(steps, "x\nx\nx\nx\nx\nx\nx\n"), "(lines 22, 23, 24, 25, 26 and 2 more)");
  const auto told = [](const std::string& text) { return text.find("motion") != std::string::npos; };
  EXPECT_FALSE(told(warnings(steps, "")));
  EXPECT_FALSE(told(warnings("time_s,robot,omega_radps,v_mps\n", "20,a,x,1\n"))) << "speeds go on";
  rows.clear();
  for (int i = 0; i < 20; ++i) rows += std::to_string(i) + ",a," + std::to_string(i) + ",0,0\n";
  EXPECT_FALSE(told(warnings("time_s,robot,x_m,y_m,heading_rad\n", "20,a,x,1,1\n"))) << "poses say where";
}

// Of observations nothing more is lost than they.
TEST_F(ImportCsvTest, SkippedObservationsLoseNoMotion) {
  options_.skip_bad = true;
  PutObservations("1,Rosa,,,\nx,Rosa,,,\n");
  EXPECT_EQ(WarningsText(Import().warnings).find("motion"), std::string::npos);
}

}  // namespace
}  // namespace cairn::datasets
