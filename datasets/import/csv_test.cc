#include "datasets/import/csv.h"

#include <cmath>
#include <map>

#include "datasets/import/csv_reader.h"
#include "datasets/import/testing_csv.h"

namespace cairn::datasets {
namespace {

TEST_F(ImportCsvTest, PutsEveryColumnInItsPlace) {
  PutObservations("1,Rosa,door,2.5,0.1\n2,Rosa,,,\n2,Ugo,arch,1,4\n3,Rosa,door,2,0\n");
  const ImportReport report = Import();
  EXPECT_EQ(log_.Texts("robots"), (std::vector<std::string>{"Rosa", "Ugo"}));
  EXPECT_EQ(log_.Texts("landmarks"), (std::vector<std::string>{"arch", "door"}));
  EXPECT_EQ(Column<double>("robot/0/odometry/time_s"), (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(Column<double>("robot/0/odometry/turn_rad"), (std::vector<double>{0, 0.25, -0.25}));
  EXPECT_EQ(Column<double>("robot/1/odometry/forward_m"), (std::vector<double>{1, 1}));
  EXPECT_EQ(Column<double>("robot/0/observations/time_s"), (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(Column<std::int32_t>("robot/0/observations/landmark"), (std::vector<std::int32_t>{1, -1, 1}));
  EXPECT_EQ(Column<std::int32_t>("robot/1/observations/landmark"), (std::vector<std::int32_t>{0}));
  EXPECT_TRUE(std::isnan(Column<double>("robot/0/observations/range_m")[1]));
  EXPECT_TRUE(std::isnan(Column<double>("robot/0/observations/bearing_rad")[1]));
  EXPECT_NEAR(Column<double>("robot/1/observations/bearing_rad")[0], 4 - 2 * M_PI, 1e-15);
  EXPECT_EQ(report.robots, 2);
  EXPECT_EQ(report.controls, 5);
  EXPECT_EQ(report.observations, 4);
  EXPECT_EQ(report.contacts, 1);
  EXPECT_EQ(report.landmarks, 2);
  EXPECT_TRUE(report.warnings.empty());
  EXPECT_FALSE(log_.Has("truth/landmarks/name"));
}

TEST_F(ImportCsvTest, ARowThatIsTheSameAsAnEarlierOneIsLeftOut) {
  // The same but for its robot, its landmark, its time, its range or its bearing is another.
  PutObservations(
      "1,Rosa,,2.5,0.1\n1,Rosa,door,2.5,0.1\n1,Rosa,,2.5,0.1\n1,Rosa,door,2.5,0.1\n1,Rosa,,2.5,0.2\n"
      "1,Rosa,,2.4,0.1\n1,Rosa,,,\n1,Rosa,,,\n2,Rosa,,2.5,0.1\n2,Ugo,,2.5,0.1\n");
  const ImportReport report = Import();
  EXPECT_EQ(Column<double>("robot/0/observations/time_s"), (std::vector<double>{1, 1, 1, 1, 1, 2}));
  EXPECT_EQ(Column<double>("robot/1/observations/time_s"), (std::vector<double>{2}));
  EXPECT_EQ(
      report.dropped,
      (std::map<std::string, std::int64_t>{{"row of an observation that is the same as an earlier one", 3}}));
}

TEST_F(ImportCsvTest, IntegratesVelocities) {
  options_.odometry =
      folder_.Put("v.csv.gz", "omega_radps,robot,time_s,v_mps\n0.5,a,0,2\n0,a,1,1\n0,a,3,0\n");
  PutObservations("0,a,,,\n");
  Import();
  EXPECT_EQ(Column<double>("robot/0/odometry/time_s"), (std::vector<double>{0, 1, 1, 3}));
  EXPECT_EQ(Column<double>("robot/0/odometry/turn_rad"), (std::vector<double>{0, 0.25, 0.25, 0}));
  EXPECT_EQ(Column<double>("robot/0/odometry/forward_m"), (std::vector<double>{0, 2, 0, 2}));
}

TEST_F(ImportCsvTest, OneRobotNeedsNoName) {
  options_.odometry = folder_.Put("o.csv", "time_s,turn_rad,forward_m\n1,0,1\n2,0.5,1\n");
  options_.observations = folder_.Put("s.csv", "time_s,landmark,range_m,bearing_rad\n1,door,2,0.1\n");
  options_.truth_poses = folder_.Put("t.csv", "time_s,x_m,y_m,heading_deg\n1,5,6,90\n");
  Import();
  EXPECT_EQ(log_.Texts("robots"), std::vector<std::string>{"robot"});
  EXPECT_EQ(Column<double>("robot/0/odometry/time_s"), (std::vector<double>{1, 2}));
  EXPECT_EQ(Column<double>("robot/0/observations/range_m"), std::vector<double>{2});
  EXPECT_NEAR(Column<double>("truth/robot/0/poses/heading_rad")[0], M_PI / 2, 1e-15);
  options_.observations =
      folder_.Put("s.csv", "time_s,robot,landmark,range_m,bearing_rad\n1,anna,door,2,0.1\n");
  ExpectContains(Failure(), "s.csv:2: unknown robot: 'anna' has no odometry; its file has no column 'robot'");
}

TEST_F(ImportCsvTest, OfSeveralRobotsTheRobotIsNeeded) {
  options_.observations = folder_.Put("s.csv", "time_s,landmark,range_m,bearing_rad\n2,door,2,0.1\n");
  ExpectContains(Failure(), "s.csv:1: the header lacks 'robot'; odometry is of 2 robots");
  options_.observations = folder_.Put("s.csv", "# mine\ntime_s,landmark,range_m,bearing_rad\n2,door,2,0.1\n");
  ExpectContains(Failure(), "s.csv:2: the header lacks 'robot'");
}

TEST_F(ImportCsvTest, MoreRobotsThanAFleetHasAreRefused) {
  std::string rows;
  for (int robot = 0; robot <= 1000; ++robot)
    rows += std::to_string(robot) + ",r" + std::to_string(robot) + ",0,1\n";
  options_.odometry = folder_.Put("o.csv", "time_s,robot,turn_rad,forward_m\n" + rows);
  ExpectContains(Failure(), "o.csv: names more than 1000 robots: is its column 'robot' something else?");
}

// Dead reckoning by the controls leads where the poses lie, from the first one on.
TEST_F(ImportCsvTest, TakesOdometryAsPoses) {
  options_.odometry =
      folder_.Put("o.csv", "time_s,x_m,y_m,heading_deg\n1,10,5,90\n2,10,6,90\n3,10,6,180\n4,8,6,180\n");
  Import();
  const auto turn = Column<double>("robot/0/odometry/turn_rad"),
             forward = Column<double>("robot/0/odometry/forward_m");
  double x = 10, y = 5, heading = M_PI / 2;
  for (std::size_t i = 0; i < turn.size(); ++i) {
    heading += turn[i];
    x += forward[i] * std::cos(heading);
    y += forward[i] * std::sin(heading);
  }
  EXPECT_NEAR(x, 8, 1e-9);
  EXPECT_NEAR(y, 6, 1e-9);
  EXPECT_NEAR(heading, M_PI, 1e-9);
  EXPECT_EQ(Column<double>("robot/0/odometry/time_s").back(), 4);
}

TEST_F(ImportCsvTest, TruthIsByAssociationsInOrderOfTheirTime) {
  PutObservations("1,Rosa,,2,0\n1,Rosa,,3,0\n2,Rosa,,,\n2,Ugo,,,\n");
  options_.truth_landmarks = folder_.Put("landmarks.csv", "landmark,x_m,y_m\nb,1,2\na,3,4\n");
  options_.truth_associations =
      folder_.Put("associations.csv", "time_s,robot,landmark\n1,Rosa,a\n2,Ugo,b\n1,Rosa,b\n");
  options_.truth_poses = folder_.Put("poses.csv", "time_s,robot,x_m,y_m,heading_rad\n1,Ugo,5,6,-3.5\n");
  Import();
  EXPECT_EQ(Column<std::int32_t>("truth/robot/0/observations/landmark"),
            (std::vector<std::int32_t>{1, 0, -1}));
  EXPECT_EQ(Column<std::int32_t>("truth/robot/1/observations/landmark"), (std::vector<std::int32_t>{0}));
  EXPECT_EQ(log_.Texts("truth/landmarks/name"), (std::vector<std::string>{"b", "a"}));
  EXPECT_EQ(Column<double>("truth/landmarks/y_m"), (std::vector<double>{2, 4}));
  EXPECT_EQ(Column<double>("truth/robot/1/poses/x_m"), (std::vector<double>{5}));
  EXPECT_NEAR(Column<double>("truth/robot/1/poses/heading_rad")[0], 2 * M_PI - 3.5, 1e-15);
  EXPECT_TRUE(log_.Texts("landmarks").empty());
}

TEST_F(ImportCsvTest, WithoutAssociationsTruthIsByName) {
  PutObservations("1,Rosa,a,2,0\n2,Rosa,b,2,0\n");
  options_.truth_landmarks = folder_.Put("landmarks.csv", "landmark,x_m,y_m\nb,1,2\na,3,4\n");
  Import();
  EXPECT_EQ(Column<std::int32_t>("truth/robot/0/observations/landmark"), (std::vector<std::int32_t>{1, 0}));
  // What one without a name is of nobody knows, and it is no false one for that.
  PutObservations("1,Rosa,a,2,0\n2,Rosa,,2,0\n");
  Import();
  EXPECT_FALSE(log_.Has("truth/robot/0/observations/landmark"));
  EXPECT_TRUE(log_.Has("truth/landmarks/name"));
}

TEST_F(ImportCsvTest, WhatProgramsWriteForAnUnknownLandmarkIsNoName) {
  for (const std::string name : {"-1", "unknown", "None", "NaN", "null", "N/A", "?", "-", "--", "*", "#"}) {
    PutObservations("1,Rosa,door,2,0\n2,Rosa," + name + ",2,0\n");
    ExpectContains(Failure(), "observations.csv:3: no landmark's name: '" + name +
                                  "': leave the field empty where it is unknown");
  }
}

// Nor is it one of a robot or of a true landmark.
TEST_F(ImportCsvTest, WhatIsNoLandmarksNameIsNobodys) {
  PutObservations("1,Rosa,door,2,0\n2,Rosa,,2,0\n");
  for (const std::string name : {"?", "nan", "-1"}) {
    options_.truth_landmarks = folder_.Put("landmarks.csv", "landmark,x_m,y_m\ndoor,1,2\n" + name + ",3,4\n");
    ExpectContains(Failure(), "landmarks.csv:3: landmark without a name of its own: '" + name + "'");
  }
  options_.truth_landmarks.clear();
  options_.odometry = folder_.Put("o.csv", "time_s,robot,turn_rad,forward_m\n1,Rosa,0,1\n2,?,0,1\n");
  ExpectContains(Failure(), "o.csv:3: unknown robot: '?' is no robot's name");
}

TEST_F(ImportCsvTest, NamesOfSignsAndLettersAreNames) {
  PutObservations("1,Rosa,a?,2,0\n1,Rosa,#1,2,0\n2,Rosa,\xC3\xA9,2,0\n2,Rosa,0,2,0\n2,Ugo,-2,2,0\n");
  Import();
  EXPECT_EQ(log_.Texts("landmarks").size(), 5U);
}

TEST_F(ImportCsvTest, ALandmarkThatTheTruthDoesNotNameIsAskedForInBothFiles) {
  PutObservations("1,Rosa,door,2,0\n");
  options_.truth_landmarks = folder_.Put("landmarks.csv", "landmark,x_m,y_m\nDoor A,1,2\n");
  const std::string said = Failure();
  ExpectContains(
      said, "observations.csv: unknown landmark: 'door', as all others, is none of the true landmarks of ");
  ExpectContains(said, "landmarks.csv ('Door A' is one): are they called the same in both files?");
}

TEST_F(ImportCsvTest, TruePositionsOfSomeLandmarksAreTakenForThese) {
  PutObservations("1,Rosa,door,2,0\n2,Rosa,plant,2,0\n2,Rosa,stove,2,0\n2,Ugo,door,2,0\n");
  const std::int64_t all = Import().observations;
  const auto without = log_.ContentHash();
  options_.truth_landmarks = folder_.Put("landmarks.csv", "landmark,x_m,y_m\ndoor,1,2\nattic,3,4\n");
  const ImportReport report = Import();
  EXPECT_EQ(report.observations, all);
  EXPECT_FALSE(log_.Has("truth/robot/0/observations/landmark")) << "-1 would be a false observation";
  EXPECT_EQ(log_.Without("truth/").ContentHash(), without);
  ASSERT_FALSE(report.warnings.empty());
  ExpectContains(report.warnings.back(),
                 "landmarks.csv: no true position of 2 of the 3 landmarks that observations name ('plant' is "
                 "one): only the others are scored");
}

TEST_F(ImportCsvTest, ARangeOfZeroIsNoRange) {
  PutObservations("1,Rosa,door,0,0.1\n");
  ExpectContains(Failure(), "observations.csv:2: range 0: some sensors say it where nothing was seen");
}

TEST_F(ImportCsvTest, ObservationsOfAnotherClockAreAskedFor) {
  PutObservations("7200,Rosa,door,2,0\n");
  ExpectContains(Failure(),
                 "after the last control: 7200.000000 after 3.000000; do both files use one clock");
  PutObservations("1700000001,Rosa,door,2,0\n");
  ExpectContains(Failure(), "after 3.000000; do both files use one clock");
  PutObservations("2000000,Rosa,door,2,0\n");
  ExpectContains(Failure(), "after 3.000000; is it in microseconds?");
}

TEST_F(ImportCsvTest, TruthOutsideTheLogIsWarnedOf) {
  PutObservations("1,Rosa,door,2,0\n2,Ugo,door,2,0\n");
  options_.truth_poses = folder_.Put("p.csv", "time_s,robot,x_m,y_m,heading_rad\n7201,Rosa,0,0,0\n");
  const ImportReport report = Import();
  ASSERT_EQ(report.warnings.size(), 1U);
  ExpectContains(report.warnings.front(), "p.csv: 1 of 1 poses lie outside the time of the log");
  ExpectContains(report.warnings.front(), "do both files use one clock");
}

TEST_F(ImportCsvTest, TimesThatBeginAnewWithoutAColumnOfRobotsAskForIt) {
  options_.odometry = folder_.Put("o.csv", "time_s,turn_rad,forward_m\n1,0,1\n9,0,1\n1,0,1\n");
  ExpectContains(Failure(),
                 "o.csv:4: time runs backwards: 1.000000 after 9.000000; rows of several robots "
                 "need a column 'robot'");
}

TEST_F(ImportCsvTest, DatesAreToldWhatTimesAre) {
  options_.odometry = folder_.Put("o.csv", "time_s,turn_rad,forward_m\n2024-05-01T12:00:00,0,1\n");
  ExpectContains(Failure(), "times are seconds of any clock, such as Unix time, no dates");
}

TEST_F(ImportCsvTest, AHoleInTheOdometryIsWarnedOf) {
  std::string rows = "time_s,x_m,y_m,heading_rad\n";
  for (int i = 0; i <= 600; ++i)
    if (i <= 200 || i >= 300) rows += std::to_string(0.1 * i) + "," + std::to_string(0.05 * i) + ",0,0\n";
  options_.odometry = folder_.Put("o.csv", rows);
  options_.observations = folder_.Put("s.csv", "time_s,landmark,range_m,bearing_rad\n25,door,2,0\n");
  const ImportReport report = Import();
  ASSERT_EQ(report.warnings.size(), 1U);
  ExpectContains(report.warnings.front(), "its odometry lacks 10 s from 20 s on");
}

TEST_F(ImportCsvTest, ARobotThatObservedNothingIsWarnedOf) {
  PutObservations("1,Rosa,door,2,0\n");
  const ImportReport report = Import();
  ASSERT_EQ(report.warnings.size(), 1U);
  ExpectContains(report.warnings.front(), "robot 'Ugo' has no observations");
  ExpectContains(report.warnings.front(), "leave its rows out of the odometry");
}

TEST_F(ImportCsvTest, NoiseParametersComeAlong) {
  options_.noise.contact_m = 0.3;
  options_.noise.max_range_m = 8;
  options_.noise.false_ratio = 0.02;
  options_.noise.miss_ratio = 0.05;
  Import();
  EXPECT_EQ(log_.Scalar<double>("noise/contact_m"), 0.3);
  EXPECT_EQ(log_.Scalar<double>("sensor/max_range_m"), 8);
  EXPECT_EQ(log_.Scalar<double>("noise/false_ratio"), 0.02);
  EXPECT_EQ(log_.Scalar<double>("noise/miss_ratio"), 0.05);
  EXPECT_FALSE(log_.Has("noise/range_m"));
}

TEST_F(ImportCsvTest, ASensorThatIsLateAndMountedBesideTheRobotIsPutRight) {
  // Half a metre ahead of the robot, turned to its left.
  options_.mounts[""] = {0.5, 0, M_PI / 2};
  options_.late_s[""] = 0.25;
  options_.noise.max_range_m = 3;
  options_.noise.field_of_view_rad = 1;
  PutObservations("1.25,Rosa,door,2,0\n2.25,Rosa,,,\n3.25,Rosa,arch,3,-0.5\n");
  Import();
  EXPECT_EQ(Column<double>("robot/0/observations/time_s"), (std::vector<double>{1, 2, 3}));
  const auto range = Column<double>("robot/0/observations/range_m"),
             bearing = Column<double>("robot/0/observations/bearing_rad");
  EXPECT_NEAR(range[0], std::hypot(0.5, 2), 1e-12);
  EXPECT_NEAR(bearing[0], std::atan2(2, 0.5), 1e-12);
  EXPECT_TRUE(std::isnan(range[1]));
  EXPECT_NEAR(range[2] * std::cos(bearing[2]), 0.5 + 3 * std::sin(0.5), 1e-12);
  EXPECT_NEAR(range[2] * std::sin(bearing[2]), 3 * std::cos(0.5), 1e-12);
  EXPECT_EQ(log_.Scalar<double>("sensor/max_range_m"), 3.5);
  EXPECT_FALSE(log_.Has("sensor/field_of_view_rad"));
}

TEST_F(ImportCsvTest, ASensorThatIsTurnedSeesWhatItSawToTheSide) {
  options_.mounts[""] = {0, 0, -0.25};
  options_.noise.field_of_view_rad = 1;
  PutObservations("1,Rosa,door,2,0.5\n");
  Import();
  EXPECT_EQ(Column<double>("robot/0/observations/range_m"), (std::vector<double>{2}));
  EXPECT_EQ(Column<double>("robot/0/observations/bearing_rad"), (std::vector<double>{0.25}));
  EXPECT_EQ(log_.Scalar<double>("sensor/field_of_view_rad"), 1.5);
}

TEST_F(ImportCsvTest, EachRobotMayHaveItsOwnMountAndClock) {
  options_.odometry = folder_.Put(
      "two.csv", "time_s,robot,turn_rad,forward_m\n0,Rosa,0,0\n0,Otto,0,0\n4,Rosa,0,1\n4,Otto,0,1\n");
  options_.mounts = {{"", {0, 0, 0.5}}, {"Otto", {0, 0, -0.25}}};
  options_.late_s = {{"Rosa", 1}};
  options_.noise.field_of_view_rad = 2;
  PutObservations("2,Rosa,door,2,0.5\n2,Otto,door,2,0.5\n");
  Import();
  EXPECT_EQ(Column<double>("robot/0/observations/time_s"), (std::vector<double>{1}));
  EXPECT_EQ(Column<double>("robot/1/observations/time_s"), (std::vector<double>{2}));
  EXPECT_EQ(Column<double>("robot/0/observations/bearing_rad"), (std::vector<double>{1}));
  EXPECT_EQ(Column<double>("robot/1/observations/bearing_rad"), (std::vector<double>{0.25}));
  EXPECT_EQ(log_.Scalar<double>("sensor/field_of_view_rad"), 3) << "of the one that sees most";
  options_.late_s = {{"Rose", 1}};
  ExpectContains(Failure(), "the sensor's clock of 'Rose': no such robot in ");
}

TEST_F(ImportCsvTest, TrueAssociationsAreByTheSensorsClockToo) {
  options_.late_s[""] = 0.1;
  options_.truth_landmarks = folder_.Put("landmarks.csv", "landmark,x_m,y_m\ndoor,3,0\n");
  options_.truth_associations = folder_.Put("who.csv", "time_s,robot,landmark\n1.1,Rosa,door\n");
  PutObservations("1.1,Rosa,,2,0\n2,Rosa,,2,0\n");
  Import();
  EXPECT_EQ(Column<std::int32_t>("truth/robot/0/observations/landmark"), (std::vector<std::int32_t>{0, -1}));
}

TEST_F(ImportCsvTest, ControlsOnlyWarn) {
  const ImportReport report = Import();
  ASSERT_EQ(report.warnings.size(), 1U);
  ExpectContains(report.warnings[0], "controls only");
  EXPECT_EQ(Column<double>("robot/0/observations/time_s").size(), 0U);
}

TEST_F(ImportCsvTest, ALogWithoutControlsIsRefused) {
  options_.odometry = folder_.Put("empty.csv", "time_s,robot,turn_rad,forward_m\n");
  ExpectContains(Failure(), "the log is empty: it has no controls");
  options_.odometry = "";
  ExpectContains(Failure(), "needs an odometry file");
}

TEST_F(ImportCsvTest, ColumnsLeftOutAreMentioned) {
  options_.odometry = folder_.Put("o.csv", "time_s,robot,turn_rad,forward_m,mood\n1,a,0,1,good\n");
  const ImportReport report = Import();
  ASSERT_FALSE(report.warnings.empty());
  ExpectContains(report.warnings[0], "o.csv: column 'mood' is left out");
}

TEST_F(ImportCsvTest, OfManyColumnsLeftOutTheFirstAreNamedAndTheRestCounted) {
  std::string header = "time_s,robot,turn_rad,forward_m", row = "1,a,0,1";
  for (int i = 0; i < 1000; ++i) {
    header += ",c" + std::to_string(i);
    row += ",0";
  }
  options_.odometry = folder_.Put("o.csv", header + "\n" + row + "\n");
  const ImportReport report = Import();
  ASSERT_GE(report.warnings.size(), 11U);
  ExpectContains(report.warnings[9], "column 'c9' is left out");
  ExpectContains(report.warnings[10], "o.csv: 990 more columns are left out");
}

// Real files of that form, made by a simulator of other hands: counts as its index states them.
TEST(ImportCsvData, TakesTheTwentyLoops) {
  if (DataFolder().empty()) GTEST_SKIP() << "CAIRN_DATA is not set";
  const std::string folder = DataFolder() + "/loops-csv/";
  BadLines bad(false);
  CsvReader index(folder + "index.csv", {{"difficulty", "number", "controls", "presses"}}, &bad);
  int logs = 0;
  for (; index.Next(); ++logs) {
    const std::string loop = folder + std::string(index.Text(0)) + "-" + std::string(index.Text(1)) + "/";
    CsvImportOptions options;
    options.odometry = loop + "odometry.csv.gz";
    options.observations = loop + "observations.csv";
    options.truth_poses = loop + "truth_poses.csv.gz";
    options.truth_landmarks = loop + "truth_landmarks.csv";
    options.truth_associations = loop + "truth_associations.csv";
    Blob log;
    const ImportReport report = ImportCsv(options, &log);
    EXPECT_EQ(static_cast<double>(report.controls), index.Number(2).value()) << loop;
    EXPECT_EQ(static_cast<double>(report.contacts), index.Number(3).value()) << loop;
    EXPECT_EQ(report.observations, report.contacts) << loop;
    for (const std::int32_t landmark : log.Get<std::int32_t>("truth/robot/0/observations/landmark")) {
      EXPECT_GE(landmark, 0) << loop;
    }
    EXPECT_EQ(log.at("truth/robot/0/poses/x_m").size(), report.controls + 1) << loop;
  }
  EXPECT_EQ(logs, 20);
}

}  // namespace
}  // namespace cairn::datasets
