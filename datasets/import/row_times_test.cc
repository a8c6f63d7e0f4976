#include "datasets/import/row_times.h"

#include <cmath>

#include "datasets/import/csv.h"
#include "datasets/testing.h"

namespace cairn::datasets {
namespace {

class TimeOrderTest : public ImportTest {
 protected:
  CsvImportOptions options_;

  std::string FailureOf(const std::string& odometry, bool skip_bad) {
    options_.odometry = folder_.Put("o.csv", odometry);
    options_.skip_bad = skip_bad;
    return InputErrorOf([this] { ImportCsv(options_, &log_); });
  }
};

TEST_F(TimeOrderTest, RowsThatAreNotSortedAreToBeSorted) {
  for (const std::string columns : {"x_m,y_m,heading_rad", "v_mps,omega_radps"}) {
    std::string rows = "time_s," + columns + "\n";
    for (int i = 0; i < 20; ++i)
      rows += std::to_string(7 * i % 20) + (columns.starts_with("x") ? ",0,0,0\n" : ",0,0\n");
    ExpectContains(
        FailureOf(rows, false),
        "o.csv:5: time runs backwards: 1.000000 after 14.000000, as in 12 of 20 rows: sort the rows by "
        "time; rows of several robots need a column 'robot' (--skip-bad");
    ExpectContains(FailureOf(rows, true),
                   "o.csv: --skip-bad leaves 8 of its 20 rows, less than half; skipped: "
                   "time runs backwards (12); sort the rows by time. ");
  }
}

// Robots one after the other, and one row of a wrong time: in order but for that row.
TEST_F(TimeOrderTest, FewRowsOutOfOrderAreNotToBeSorted) {
  std::string rows = "time_s,robot,turn_rad,forward_m\n";
  for (int i = 0; i < 60; ++i)
    rows += std::to_string(i == 30 ? 5 : i % 20) + ",r" + std::to_string(i / 20) + ",0,0\n";
  ExpectContains(FailureOf(rows, false),
                 "o.csv:32: time runs backwards: 5.000000 after 9.000000 (--skip-bad");
  EXPECT_EQ(FailureOf(rows, true), "");
}

TEST_F(TimeOrderTest, EachRobotHasAnOrderOfItsOwn) {
  std::string rows = "time_s,robot,turn_rad,forward_m\n";
  for (int i = 0; i < 40; ++i) rows += std::to_string(i) + ",a,0,0\n" + std::to_string(40 - i) + ",b,0,0\n";
  ExpectContains(
      FailureOf(rows, false),
      "o.csv:5: time runs backwards: 39.000000 after 40.000000, as in 39 of 80 rows: sort the rows");
}

// Of rows a tenth of a second apart, of which each `rows` have the time of the first.
std::string DoubtOf(int rows) {
  TimeDigits digits;
  for (int i = 0; i < 4000; ++i) {
    const int first = i / rows * rows;
    digits.Add(1.7e9 + 0.1 * first);
  }
  return digits.Doubt();
}

TEST(TimeDigits, AreTooFewWhereHundredsOfRowsHaveOneTime) {
  EXPECT_EQ(DoubtOf(4000), "4000 rows have 1 time: were they written with too few digits?");
  EXPECT_EQ(DoubtOf(1000), "4000 rows have 4 times: were they written with too few digits?");
  EXPECT_EQ(DoubtOf(1), "");
  EXPECT_EQ(DoubtOf(10), "") << "whole seconds";
  EXPECT_EQ(TimeDigits().Doubt(), "");
}

// A drive of a minute with ten rows of odometry and two observations a second, of which either file's times
// may be rounded.
class RoundedTimes : public ImportTest {
 protected:
  CsvImportOptions options_;

  void Drive(double (*odometry)(double), double (*observations)(double), double from_s = 1.7e9) {
    std::string rows = "time_s,turn_rad,forward_m\n", seen = "time_s,landmark,range_m,bearing_rad\n";
    for (int i = 0; i < 600; ++i) {
      rows += std::to_string(odometry(from_s + 0.1 * i)) + ",0.01,0.05\n";
      if (i % 5 == 3)
        seen +=
            std::to_string(observations(from_s + 0.1 * i)) + (i % 2 == 0 ? ",door,2,0\n" : ",door,3,0.1\n");
    }
    options_.odometry = folder_.Put("o.csv", rows);
    options_.observations = folder_.Put("s.csv", seen);
  }
  std::string Failure() {
    return InputErrorOf([this] { ImportCsv(options_, &log_); });
  }
  std::vector<std::string> Warnings() { return ImportCsv(options_, &log_).warnings; }
};

double AsItIs(double time_s) { return time_s; }
double Down(double time_s) { return std::floor(time_s); }
double Up(double time_s) { return std::ceil(time_s); }

constexpr const char* kHint = "are times rounded to whole seconds? Give them with fractions of a second";

TEST_F(RoundedTimes, AnObservationJustBeyondTheLogIsTheirWork) {
  Drive(Down, AsItIs);
  ExpectContains(Failure(),
                 std::string("after the last control: 1700000059.300000 after 1700000059.000000; ") + kHint);
  Drive(AsItIs, Up);
  ExpectContains(Failure(),
                 std::string("after the last control: 1700000060.000000 after 1700000059.900000; ") + kHint);
  Drive(Up, AsItIs, 0.5);
  ExpectContains(Failure(), std::string("before the first control: 0.800000 before 1.000000; ") + kHint);
  options_.skip_bad = true;
  EXPECT_EQ(Failure(), "");
}

TEST_F(RoundedTimes, AnObservationThatIsLateForAnotherReasonIsNot) {
  Drive(AsItIs, [](double time_s) { return time_s + 0.7; });
  EXPECT_EQ(Failure().find(kHint), std::string::npos) << Failure();
  Drive(Down, [](double time_s) { return time_s + 90; });
  EXPECT_EQ(Failure().find(kHint), std::string::npos) << Failure();
}

TEST_F(RoundedTimes, AnAssociationOfNoObservationMayBeTheirWork) {
  Drive(AsItIs, AsItIs, 0);
  options_.truth_landmarks = folder_.Put("l.csv", "landmark,x_m,y_m\ndoor,1,2\n");
  options_.truth_associations = folder_.Put("a.csv", "time_s,landmark\n0,door\n1,door\n");
  ExpectContains(Failure(),
                 std::string("a.csv:2: no such observation: of robot 'robot' at 0.000000; ") + kHint);
  options_.truth_associations = folder_.Put("a.csv", "time_s,landmark\n0,door\n1.3,door\n");
  EXPECT_EQ(Failure().find(kHint), std::string::npos) << Failure();
}

TEST_F(RoundedTimes, WhatCanBeReadInIsWithAWarning) {
  Drive(Down, Down);
  EXPECT_EQ(Warnings(),
            (std::vector<std::string>{
                options_.odometry + ": robot 'robot': 600 rows have 60 times, all whole seconds: " + kHint,
                options_.observations +
                    ": robot 'robot': 60 of 120 rows are of a landmark that another row is of at the same "
                    "time, all times whole seconds: " +
                    kHint}));
  Drive(AsItIs, AsItIs);
  EXPECT_EQ(Warnings(), std::vector<std::string>{});
}

// A log of one row a second has no other times, and one that turns, then goes has each twice.
TEST(TimeDigits, OfWholeSecondsAreEnoughForARowASecond) {
  TimeDigits one, two, three;
  for (int i = 0; i < 100; ++i) {
    one.Add(i);
    for (int k = 0; k < 3; ++k) (k < 2 ? two : three).Add(i);
  }
  for (int i = 0; i < 100; ++i) three.Add(99);
  EXPECT_EQ(one.Rounded(), "");
  EXPECT_EQ(two.Rounded(), "");
  EXPECT_EQ(three.Rounded(), "");
  three.Add(99);
  ExpectContains(three.Rounded(), "201 rows have 100 times, all whole seconds: are times rounded");
}

TEST(TimeDigits, AreAskedForBeforeObservationsAre) {
  const TestFolder folder;
  for (const std::string columns : {"x_m,y_m,heading_rad", "v_mps,omega_radps", "turn_rad,forward_m"}) {
    std::string rows = "time_s,robot," + columns + "\n";
    for (int i = 0; i < 50; ++i) {
      rows += "1.7e+09,anna,0,0" + std::string(columns.starts_with("x") ? ",0\n" : "\n");
      rows += std::to_string(1700000000 + i) + ",bert,0,0" + (columns.starts_with("x") ? ",0\n" : "\n");
    }
    CsvImportOptions options;
    options.odometry = folder.Put("o.csv", rows);
    options.observations =
        folder.Put("s.csv", "time_s,robot,landmark,range_m,bearing_rad\n1700000001,anna,door,2,0\n");
    Blob log;
    ExpectContains(InputErrorOf([&] { ImportCsv(options, &log); }),
                   "o.csv: robot 'anna': 50 rows have 1 time: were they written with too few digits?");
  }
}

}  // namespace
}  // namespace cairn::datasets
