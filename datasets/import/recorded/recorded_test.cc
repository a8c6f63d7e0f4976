#include "datasets/import/recorded/recorded.h"

#include <cmath>
#include <numbers>

#include "datasets/testing.h"

namespace cairn::datasets {
namespace {

class ImportRecordedTest : public ImportTest {
 protected:
  RecordedImportOptions options_;
  void SetUp() override { options_.folder = folder_ / ""; }
  void PutLego() {
    folder_.Put("robot4_motors.txt",
                "M 200 1000 0 0 0 500 0 0 0 0 0 0 0\nM 400 2000 0 0 0 1500 0 0 0 0 0 0 0\n"
                "M 400 2000 0 0 0 1600 0 0 0 0 0 0 0\n");
    folder_.Put("cylinders.txt", "D C 970.0 0.0 -30.0 500.0 \nD C \nD C 1970 0\n");
    folder_.Put("robot4_reference.txt.gz", "P 378 1850 1897\nP 494 1851 1897\nP 699 1851 1997\n");
    folder_.Put("robot_arena_landmarks.txt", "L C 1291.0\t1881.0\t55.0");
  }
  void PutPark() {
    folder_.Put("GPS.txt", "0.000\t0.0\t0.0\n1.0\t2.0\t0.0\n");
    std::filesystem::create_directories(folder_ / "trees");
    folder_.Put("trees/time.txt", "  2.2000000e+004\n 2.3e4\n 2.4e4\n");
    folder_.Put("trees/speed.txt", "2\n2\n0\n");
    folder_.Put("trees/steering.txt", "0\n0.1\n0\n");
    folder_.Put("trees/lasersampling.txt", "21000\n22500\n");
    const std::string zeros = " 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 2.6e-8 0\n";
    folder_.Put("trees/ObservationDistance.txt.gz", "5" + zeros + "10" + zeros);
    folder_.Put("trees/ObservationAngle.txt.gz", "1" + zeros + "1.5707963267948966" + zeros);
  }
};

TEST_F(ImportRecordedTest, LegoTicksPolesAndReferenceBelongTogetherByTheirRows) {
  PutLego();
  const ImportReport report = ImportLegoRobot(options_, &log_);
  EXPECT_EQ(report.observations, 3);
  EXPECT_EQ(Column<double>("robot/0/odometry/time_s"), (std::vector<double>{0.2, 0.4, 0.4, 0.401, 0.401}));
  const auto forward = Column<double>("robot/0/odometry/forward_m"),
             turn = Column<double>("robot/0/odometry/turn_rad");
  EXPECT_NEAR(forward[1], 0.349, 1e-12);
  EXPECT_NEAR(turn[1], 0.0, 1e-12);
  EXPECT_NEAR(turn[3] + turn[4], 0.0349 / 0.155, 1e-12);  // the right wheel alone: to the left
  EXPECT_EQ(Column<double>("robot/0/observations/time_s"), (std::vector<double>{0.2, 0.2, 0.401}));
  EXPECT_NEAR(Column<double>("robot/0/observations/range_m")[0], 1.0, 1e-12);
  EXPECT_NEAR(Column<double>("robot/0/observations/bearing_rad")[1], std::numbers::pi / 2, 1e-12);
  EXPECT_EQ(Column<std::int32_t>("robot/0/observations/landmark"), (std::vector<std::int32_t>{-1, -1, -1}));
  EXPECT_EQ(Column<double>("truth/robot/0/poses/x_m"), (std::vector<double>{1.85, 1.851, 1.851}));
  EXPECT_NEAR(Column<double>("truth/robot/0/poses/heading_rad")[2], std::atan2(100.0, 1.0), 1e-9);
  EXPECT_EQ(Column<double>("truth/landmarks/y_m"), (std::vector<double>{1.881}));
}

TEST_F(ImportRecordedTest, LegoBadLinesAreNamedOrCounted) {
  PutLego();
  folder_.Put("cylinders.txt", "D C 1 2\nD C 1 2 3\nD C x 2\n");
  ExpectContains(InputErrorOf([&] { ImportLegoRobot(options_, &log_); }),
                 "cylinders.txt:2: wrong number of columns");
  std::filesystem::remove(folder_ / "robot4_motors.txt");
  ExpectContains(InputErrorOf([&] { ImportLegoRobot(options_, &log_); }), "there is no robot4_motors.txt");
}

// Rows keep their lines, so that a doubt names them.
TEST_F(ImportRecordedTest, WhatNoRobotDoesIsNamedWithFileAndLine) {
  PutLego();
  folder_.Put("robot4_motors.txt", "M 1000 0 0 0 0 0\n\nM 1100 0 0 0 0 0\nM 3100 999999 0 0 0 999999\n");
  const auto lego = ImportLegoRobot(options_, &log_).unit_doubts;
  ASSERT_FALSE(lego.empty());
  ExpectContains(lego[0], "robot4_motors.txt:4: robot 'lego'");
  PutPark();
  folder_.Put("trees/speed.txt", "2\n2000\n2000\n");
  const auto park = ImportVictoriaPark(options_, &log_).unit_doubts;
  ASSERT_FALSE(park.empty());
  ExpectContains(park[0], "time.txt:3: robot 'car'");
}

TEST_F(ImportRecordedTest, VictoriaParkTellsTreesFromTheRearAxleAndGpsByTheTreesClock) {
  PutPark();
  const ImportReport report = ImportVictoriaPark(options_, &log_);
  EXPECT_EQ(report.observations, 1);
  EXPECT_EQ(report.dropped.at("scan outside the controls' time"), 1);
  EXPECT_EQ(Column<double>("robot/0/observations/time_s"), (std::vector<double>{22.5}));
  EXPECT_NEAR(Column<double>("robot/0/observations/range_m")[0], std::hypot(13.78, 0.5), 1e-12);
  EXPECT_NEAR(Column<double>("robot/0/observations/bearing_rad")[0], std::atan2(0.5, 13.78), 1e-12);
  const auto forward = Column<double>("robot/0/odometry/forward_m"),
             turn = Column<double>("robot/0/odometry/turn_rad");
  EXPECT_NEAR(forward[1], 2.0, 1e-12);  // straight on, every wheel is as fast
  const double middle = 2.0 / (1.0 - std::tan(0.1) * 0.76 / 2.83);
  EXPECT_NEAR(forward[2], middle, 1e-12);
  EXPECT_NEAR(turn[2] + turn[3], middle * std::tan(0.1) / 2.83, 1e-12);
  EXPECT_NEAR(Column<double>("truth/robot/0/poses/time_s")[1], 21.967, 1e-12);
  EXPECT_NEAR(Column<double>("truth/robot/0/poses/heading_rad")[0], std::numbers::pi / 2, 1e-12);
}

TEST_F(ImportRecordedTest, VictoriaParkColumnsMustBeAsLong) {
  PutPark();
  folder_.Put("trees/speed.txt", "2\n2\n");
  ExpectContains(InputErrorOf([&] { ImportVictoriaPark(options_, &log_); }), "differ in length");
  folder_.Put("trees/speed.txt", "2\n2\nnan\n");
  ExpectContains(InputErrorOf([&] { ImportVictoriaPark(options_, &log_); }), "speed.txt:3: not finite");
}

TEST(Course, HoldsWhereNothingMovesAndBeginsWithTheFirstMove) {
  EXPECT_EQ(Course({0, 0.1, 1, 1, 1}, {0, 0, 0, 0.1, 2}, 0.5),
            (std::vector<double>{0, 0, 0, 0, std::numbers::pi / 2}));
  EXPECT_EQ(Course({0, 0, 0}, {0, 0, 5}, 1.0), (std::vector<double>(3, std::numbers::pi / 2)));
  EXPECT_TRUE(Course({}, {}, 1.0).empty());
}

// The recordings themselves hold what their makers say of them.
TEST(ImportRecordedData, HoldsWhatIsKnownOfIt) {
  if (DataFolder().empty()) GTEST_SKIP() << "CAIRN_DATA is not set (docs/datasets.md)";
  RecordedImportOptions options;
  Blob log;
  options.folder = DataFolder() + "/lego-robot";
  EXPECT_EQ(ImportLegoRobot(options, &log).observations, 893);
  EXPECT_EQ(log.Texts("truth/landmarks/name").size(), 6U);
  options.scans = true;
  const ImportReport lego = ImportLegoRobot(options, &log);
  EXPECT_EQ(lego.scans, 278);
  EXPECT_EQ(lego.observations, 0);
  const std::span<const double> ahead_m = log.Get<double>("robot/0/laser/range_m").subspan(341, 1);
  EXPECT_GT(ahead_m[0], 0.1) << "in metres";
  EXPECT_LT(ahead_m[0], 3);
  options.scans = false;
  options.folder = DataFolder() + "/victoria-park";
  const ImportReport park = ImportVictoriaPark(options, &log);
  EXPECT_GT(park.observations, 50000);
  double travelled = 0;
  for (const double forward : log.Get<double>("robot/0/odometry/forward_m")) travelled += std::abs(forward);
  EXPECT_NEAR(travelled, 4030, 100);
}

}  // namespace
}  // namespace cairn::datasets
