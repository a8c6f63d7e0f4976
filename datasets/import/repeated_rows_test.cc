#include "datasets/import/repeated_rows.h"

#include <gtest/gtest.h>

#include <string>
#include <tuple>
#include <vector>

#include "datasets/import/csv.h"
#include "datasets/import/recorded/carmen.h"
#include "datasets/import/recorded/mrclam.h"
#include "datasets/testing.h"

namespace cairn::datasets {
namespace {

class RepeatedRowsTest : public ImportTest {
 protected:
  CsvImportOptions options_;
  ImportReport Import(const std::string& header, const std::string& rows) {
    options_.odometry = folder_.Put("odometry.csv", header + rows);
    return ImportCsv(options_, &log_);
  }
  std::vector<double> Forward() const { return Column<double>("robot/0/odometry/forward_m"); }
};

constexpr char kSteps[] = "time_s,turn_rad,forward_m\n";

// `per_time` steps of each whole second, of which the ones from `from` to `end` stand there `copies` times.
std::string Steps(int seconds, int per_time, int from, int end, int copies, int kinds = 1000) {
  std::string rows;
  for (int s = 0; s < seconds; ++s)
    for (int copy = 0; copy < (s >= from && s < end ? copies : 1); ++copy)
      for (int i = 0; i < per_time; ++i)
        rows += std::to_string(s) + ".5,0.01," + std::to_string(0.1 + 0.001 * ((7 * s + i) % kinds)) + "\n";
  return rows;
}

TEST_F(RepeatedRowsTest, StepsOfFilesThatOverlapCountOnce) {
  Import(kSteps, Steps(100, 1, 0, 0, 1));
  const std::vector<double> once = Forward();
  for (const auto& [from, end, left_out] : {std::tuple{40, 60, 20}, {0, 100, 100}, {50, 51, 1}}) {
    const ImportReport report = Import(kSteps, Steps(100, 1, from, end, 2));
    EXPECT_EQ(Forward(), once);
    EXPECT_EQ(report.dropped.at("row of odometry that is the same as an earlier one"), left_out);
  }
}

TEST_F(RepeatedRowsTest, SoDoStepsOfFewKindsWhereEveryRowOfATimeIsTheSame) {
  Import(kSteps, Steps(100, 1, 0, 0, 1, 2));
  const std::vector<double> once = Forward();
  EXPECT_EQ(Import(kSteps, Steps(100, 1, 30, 80, 2, 2)).controls, 100);
  EXPECT_EQ(Forward(), once);
}

TEST_F(RepeatedRowsTest, EqualStepsOfDifferentTimesAndAtRestStay) {
  const ImportReport report = Import(kSteps, "1,0,0.1\n2,0,0.1\n3,0,0\n3,0,0\n4,0.1,0.1\n4,0.1,0\n");
  EXPECT_EQ(Forward(), (std::vector<double>{0.1, 0.1, 0, 0, 0.1, 0}));
  EXPECT_TRUE(report.dropped.empty());
}

// As Cairn's own export writes them, turns on the spot too: half of the turn, the way, half of the turn.
TEST_F(RepeatedRowsTest, HalvesOfATurnOnTheSpotAreMotionAndCountOnceWhereTheLogIsThereTwice) {
  const auto log = [](int from, int end) {
    std::string rows;
    for (int s = 0; s < 60; ++s)
      for (int copy = 0; copy < (s >= from && s < end ? 2 : 1); ++copy) {
        const std::string at = std::to_string(s) + ".5,";
        const bool turns_only = s < 5 || (s > 20 && s < 30);
        rows += at + "0.05," + (turns_only ? "0" : std::to_string(0.1 + 0.001 * s)) + "\n" + at + "0.05,0\n";
      }
    return rows;
  };
  ImportReport report = Import(kSteps, log(0, 0));
  EXPECT_EQ(report.controls, 120);
  EXPECT_TRUE(report.dropped.empty());
  const std::vector<double> once = Forward();
  for (const auto& [from, end] : {std::pair{0, 60}, {0, 15}, {18, 40}}) {
    report = Import(kSteps, log(from, end));
    EXPECT_EQ(report.controls, 120) << from;
    EXPECT_EQ(Forward(), once) << from;
  }
}

TEST_F(RepeatedRowsTest, StepsOfACoarseClockAreMotion) {
  std::string rows;
  int state = 1;
  for (int i = 0; i < 1000; ++i) {
    state = state * 75 % 65537;
    rows += std::to_string(i / 10) + ",0," + std::to_string(0.1 + 0.01 * (state % 4)) + "\n";
  }
  EXPECT_EQ(Import(kSteps, rows).controls, 1000);
}

TEST_F(RepeatedRowsTest, WhatMayBeEitherIsRefusedUntilSomebodySaysWhich) {
  std::string rows;
  for (int i = 0; i < 100; ++i) rows += std::to_string(i / 2) + ",0,0.1\n";
  ExpectContains(InputErrorOf([&] { Import(kSteps, rows); }),
                 "odometry.csv:3: robot 'robot': the row is the same as that of line 2, of the same time, as "
                 "are 50 of its 100 rows");
  options_.repeated_steps = RepeatedSteps::kMotion;
  EXPECT_EQ(Import(kSteps, rows).controls, 100);
  options_.repeated_steps = RepeatedSteps::kCopies;
  EXPECT_EQ(Import(kSteps, rows).controls, 50);
}

TEST_F(RepeatedRowsTest, PosesVelocitiesAndTruePosesAreToldToo) {
  const std::string poses = "time_s,x_m,y_m,heading_rad\n", rows = "1,0,0,0\n1,0,0,0\n2,1,0,0\n2,1,0,0\n";
  options_.truth_poses = folder_.Put("truth.csv", poses + rows);
  ImportReport report = Import(poses, rows);
  EXPECT_EQ(report.dropped.at("row of odometry that is the same as an earlier one"), 2);
  EXPECT_EQ(report.dropped.at("row of a true pose that is the same as an earlier one"), 2);
  EXPECT_EQ(Column<double>("truth/robot/0/poses/x_m"), (std::vector<double>{0, 1}));
  report = Import("time_s,v_mps,omega_radps\n", "1,1,0\n1,1,0\n2,0,0\n");
  EXPECT_EQ(report.dropped.at("row of odometry that is the same as an earlier one"), 1);
  EXPECT_EQ(Forward(), (std::vector<double>{0, 1}));
}

TEST_F(RepeatedRowsTest, ACarmenLogThatIsThereTwiceIsTheSameLog) {
  std::string text;
  for (const std::string n : {"1", "2", "3", "4"})
    text += "FLASER 3 1 2 " + n + " " + n + " 0 0 " + n + " 0 0 " + n + "0 host " + n + "0\n";
  CarmenImportOptions options;
  options.path = folder_.Put("a.log", text);
  ImportCarmen(options, &log_);
  const Hash once = log_.ContentHash();
  options.path = folder_.Put("b.log", text + text);
  EXPECT_EQ(ImportCarmen(options, &log_).dropped.at("line or message that is the same as an earlier one"), 4);
  EXPECT_EQ(log_.ContentHash(), once);
}

TEST_F(RepeatedRowsTest, MeasurementsOfMrclamCountOnceAndOfTwoTextsNoneIsTaken) {
  folder_.Put("Barcodes.dat", "1 5\n6 63\n");
  folder_.Put("Robot1_Odometry.dat", "10 1 0\n12 0 0\n");
  folder_.Put("Robot1_Measurement.dat", "10 63 1 0.5\n10 63 1 0.5\n11 63 1 0.5\n");
  MrclamImportOptions options;
  options.folder = folder_ / "";
  const ImportReport report = ImportMrclam(options, &log_);
  EXPECT_EQ(report.dropped.at("measurement that is the same as an earlier one"), 1);
  EXPECT_EQ(Column<double>("robot/0/observations/time_s"), (std::vector<double>{10, 11}));
  folder_.Put("Robot1_Odometry.dat.gz", "10 1 0\n12 0 0\n");  // the same
  ImportMrclam(options, &log_);
  folder_.Put("Robot1_Odometry.dat.gz", "12 1 0\n13 0 0\n");
  ExpectContains(InputErrorOf([&] { ImportMrclam(options, &log_); }),
                 "Robot1_Odometry.dat: Robot1_Odometry.dat.gz beside it holds another text");
}

}  // namespace
}  // namespace cairn::datasets
