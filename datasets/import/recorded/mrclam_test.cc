#include "datasets/import/recorded/mrclam.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "datasets/testing.h"

namespace cairn::datasets {
namespace {

class ImportMrclamTest : public ImportTest {
 protected:
  MrclamImportOptions options_;

  void SetUp() override {
    options_.folder = folder_ / "";
    folder_.Put("Barcodes.dat", "# Subject #    Barcode #\n  1 \t   5 \n  2 \t  14 \n 17 7\n  6 \t  63 \n");
    folder_.Put("Landmark_Groundtruth.dat", "# x\n 6 1.0 2.0 0.1 0.1\n 17 3.0 4.0 0.1 0.1\n");
    folder_.Put("Robot1_Odometry.dat",
                "# c\r\n 10.0 \t 1.0 \t 0.5 \r\n 11.0 0 0\r\n 11.0 1 0 \r\n12 0 0\r\n");
    folder_.Put("Robot2_Odometry.dat.gz", "10 1 0\n12 0 0\n");
    folder_.Put("Robot1_Measurement.dat",
                "9 63 1 0\n10 63 1 0.5\n10 7 2 -0.5\n11 14 3 0\n11 99 3 0\n12.5 63 1 0\n");
    folder_.Put("Robot2_Measurement.dat", "# it saw nothing\n");
    folder_.Put("Robot1_Groundtruth.dat", "10 1 2 -3\n10.5 2 3 3\n");
  }
  ImportReport Import() { return ImportMrclam(options_, &log_); }
  std::string Failure() {
    return InputErrorOf([this] { Import(); });
  }
};

TEST_F(ImportMrclamTest, PutsEveryColumnInItsPlace) {
  const ImportReport report = Import();
  EXPECT_EQ(log_.Texts("robots"), (std::vector<std::string>{"1", "2"}));
  EXPECT_EQ(log_.Texts("landmarks"), (std::vector<std::string>{"6", "17"}));
  EXPECT_EQ(Column<double>("robot/0/odometry/time_s"), (std::vector<double>{10, 11, 11, 12}));
  EXPECT_EQ(Column<double>("robot/0/odometry/turn_rad"), (std::vector<double>{0, 0.25, 0.25, 0}));
  EXPECT_EQ(Column<double>("robot/0/odometry/forward_m"), (std::vector<double>{0, 1, 0, 1}));
  EXPECT_EQ(Column<double>("robot/1/odometry/forward_m"), (std::vector<double>{0, 2}));
  EXPECT_EQ(Column<std::int32_t>("robot/0/observations/landmark"), (std::vector<std::int32_t>{0, 1}));
  EXPECT_EQ(Column<double>("robot/0/observations/bearing_rad"), (std::vector<double>{0.5, -0.5}));
  EXPECT_EQ(Column<std::int32_t>("robot/0/robot_observations/robot"), (std::vector<std::int32_t>{1}));
  EXPECT_EQ(Column<double>("robot/0/robot_observations/range_m"), (std::vector<double>{3}));
  EXPECT_EQ(Column<std::int32_t>("truth/robot/0/observations/landmark"), (std::vector<std::int32_t>{0, 1}));
  EXPECT_EQ(Column<double>("truth/landmarks/y_m"), (std::vector<double>{2, 4}));
  EXPECT_EQ(Column<double>("truth/robot/0/poses/heading_rad"), (std::vector<double>{-3, 3}));
  EXPECT_FALSE(log_.Has("truth/robot/1/poses/x_m"));
  EXPECT_EQ(log_.Scalar<double>("sensor/max_range_m"), 10);
  EXPECT_EQ(report.dropped,
            (std::map<std::string, std::int64_t>{
                {"after the last odometry", 1}, {"before the first odometry", 1}, {"unknown barcode", 1}}));
  EXPECT_EQ(report.observations, 2);
  EXPECT_EQ(report.robot_observations, 1);
}

TEST_F(ImportMrclamTest, WithheldIdentitiesStayInTheTruthOnly) {
  options_.withhold_identities = true;
  Import();
  EXPECT_TRUE(log_.Texts("landmarks").empty());
  EXPECT_EQ(Column<std::int32_t>("robot/0/observations/landmark"), (std::vector<std::int32_t>{-1, -1}));
  EXPECT_EQ(Column<std::int32_t>("truth/robot/0/observations/landmark"), (std::vector<std::int32_t>{0, 1}));
}

TEST_F(ImportMrclamTest, RobotsAsClutterAreObservationsOfNoLandmark) {
  options_.robots_as_clutter = true;
  const ImportReport report = Import();
  EXPECT_EQ(Column<std::int32_t>("robot/0/observations/landmark"), (std::vector<std::int32_t>{0, 1, -1}));
  EXPECT_EQ(Column<double>("robot/0/observations/range_m"), (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(Column<std::int32_t>("truth/robot/0/observations/landmark"),
            (std::vector<std::int32_t>{0, 1, -1}));
  EXPECT_EQ(report.robot_observations, 0);
}

TEST_F(ImportMrclamTest, GivenNoiseReplacesTheDefaults) {
  options_.noise.range_m = 0.5;
  options_.noise.forward_ratio = 0.05;
  Import();
  EXPECT_EQ(log_.Scalar<double>("noise/range_m"), 0.5);
  EXPECT_EQ(log_.Scalar<double>("noise/forward_ratio"), 0.05);
  EXPECT_EQ(log_.Scalar<double>("sensor/max_range_m"), 10);
}

// The dataset states none, and its ground truth is not for the pipeline to see.
TEST_F(ImportMrclamTest, NoNoiseIsMadeUp) {
  Import();
  ASSERT_TRUE(log_.Has("robot/0/odometry/forward_m"));
  for (const auto& [name, array] : log_.fields()) EXPECT_FALSE(name.starts_with("noise/")) << name;
}

TEST_F(ImportMrclamTest, BadLinesNameFileLineAndReason) {
  folder_.Put("Robot1_Odometry.dat", "10 1 0\n11 1 0\n10.9 1 0\n12 1 0\n");
  ExpectContains(Failure(), "Robot1_Odometry.dat:3: time runs backwards: 10.900000 after 11.000000");
  options_.skip_bad = true;
  EXPECT_EQ(Import().skipped, (std::map<std::string, std::int64_t>{{"time runs backwards", 1}}));
  EXPECT_EQ(Column<double>("robot/0/odometry/forward_m"), (std::vector<double>{0, 1, 1}));
  options_.skip_bad = false;
  folder_.Put("Robot1_Odometry.dat", "10 1 0\n11 x 0\n");
  ExpectContains(Failure(), "Robot1_Odometry.dat:2: not a number: column 2 is 'x'");
  folder_.Put("Robot1_Odometry.dat", "10 1 0\n11 0\n");
  ExpectContains(Failure(), "Robot1_Odometry.dat:2: wrong number of columns: 2 where 3 are needed");
  folder_.Put("Robot1_Odometry.dat", "10 1 0\n12 1 0\n");
  folder_.Put("Robot1_Measurement.dat", "11 63 11 0\n");
  ExpectContains(Failure(), "Robot1_Measurement.dat:1: beyond the sensor's maximum: 11.000000 m");
  folder_.Put("Robot1_Measurement.dat", "11 63 -1 0\n");
  ExpectContains(Failure(), "Robot1_Measurement.dat:1: negative range");
  folder_.Put("Robot1_Measurement.dat", "11 63 1 -0.7\n");
  ExpectContains(Failure(), "Robot1_Measurement.dat:1: outside the sensor's field of view: -0.700000 rad");
}

TEST_F(ImportMrclamTest, AFileThatIsMissingIsNamed) {
  folder_.Put("Robot4_Odometry.dat", "10 1 0\n12 1 0\n");
  ExpectContains(Failure(), "there is no Robot4_Measurement.dat(.gz) in it");
  folder_.Put("Robot4_Measurement.dat.gz", "");
  EXPECT_EQ(Import().robots, 3);
  folder_.Put("Robot5_Groundtruth.dat", "10 1 2 3\n");
  ExpectContains(Failure(), "there is no Robot5_Odometry.dat(.gz) in it");
}

TEST_F(ImportMrclamTest, AFileWithNothingInItIsNotPassedOver) {
  folder_.Put("Robot1_Measurement.dat", "# time subject range bearing\n\n");
  const ImportReport report = Import();
  EXPECT_TRUE(std::ranges::any_of(report.warnings, [](const std::string& warning) {
    return warning.find("Robot1_Measurement.dat: nothing of it can be used: robot '1' observes nothing") !=
           std::string::npos;
  }));
  folder_.Put("Robot1_Odometry.dat", "");
  ExpectContains(Failure(), "Robot1_Odometry.dat: there is no odometry in it");
}

TEST_F(ImportMrclamTest, TruthThatIsThereInPartIsWarnedOf) {
  const ImportReport report = Import();
  EXPECT_EQ(report.warnings.size(), 3U);  // the others: that robot 2 saw nothing, and what to do
  EXPECT_TRUE(std::ranges::any_of(report.warnings, [](const std::string& warning) {
    return warning.find("what is not there: Robot2_Groundtruth.dat") != std::string::npos;
  }));
}

TEST_F(ImportMrclamTest, AFolderThatIsNoneIsRefused) {
  options_.folder = folder_ / "none";
  ExpectContains(Failure(), "none: no such folder");
  const TestFolder empty;
  options_.folder = empty / "";
  ExpectContains(Failure(), "there is no Barcodes.dat(.gz) in it");
  empty.Put("Barcodes.dat", "1 5\n");
  ExpectContains(Failure(), "there is no Robot1_Odometry.dat(.gz) in it");
}

std::int64_t Sum(const std::map<std::string, std::int64_t>& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::int64_t{0},
                         [](std::int64_t sum, const auto& entry) { return sum + entry.second; });
}

double DrivenM(const Blob& log, int robot) {
  double travelled = 0;
  for (const double forward : log.Get<double>("robot/" + std::to_string(robot) + "/odometry/forward_m")) {
    travelled += std::abs(forward);
  }
  return travelled;
}

// Facts that the datasets' READMEs state.
TEST(ImportMrclamData, Dataset1And6HoldWhatTheirReadmesSay) {
  if (DataFolder().empty()) GTEST_SKIP() << "CAIRN_DATA is not set";
  struct Facts {
    const char* name;
    std::int64_t measurements, unknown;
    std::vector<double> driven_m;
  };
  for (const Facts& facts : {Facts{"mrclam1", 33947, 3, {94.0, 81.6, 81.5, 78.1, 74.3}},
                             Facts{"mrclam6", 19377, 6, {48.4, 56.2, 55.1, 43.1, 49.7}}}) {
    Blob log;
    const ImportReport report =
        ImportMrclam({DataFolder() + "/" + facts.name, false, false, {}, false}, &log);
    EXPECT_EQ(report.observations + report.robot_observations + Sum(report.dropped), facts.measurements)
        << facts.name;
    EXPECT_EQ(report.dropped.at("unknown barcode"), facts.unknown) << facts.name;
    EXPECT_EQ(report.robots, 5) << facts.name;
    EXPECT_EQ(report.landmarks, 15) << facts.name;
    EXPECT_TRUE(report.skipped.empty()) << facts.name;
    for (int robot = 0; robot < 5; ++robot) {
      EXPECT_NEAR(DrivenM(log, robot), facts.driven_m[static_cast<std::size_t>(robot)], 0.06) << facts.name;
    }
    EXPECT_EQ(log.Has("truth/robot/4/poses/x_m"), std::string(facts.name) == "mrclam6");
  }
}

// Seen from the true pose, a true landmark lies where the measurement says: the mapping of barcodes is right.
TEST(ImportMrclamData, Dataset6AgreesWithItsTruth) {
  if (DataFolder().empty()) GTEST_SKIP() << "CAIRN_DATA is not set";
  Blob log;
  ImportMrclam({DataFolder() + "/mrclam6", false, false, {}, false}, &log);
  const auto x = log.Get<double>("truth/landmarks/x_m"), y = log.Get<double>("truth/landmarks/y_m");
  for (int robot = 0; robot < 5; ++robot) {
    const std::string name = "robot/" + std::to_string(robot) + "/";
    const auto time = log.Get<double>(name + "observations/time_s"),
               range = log.Get<double>(name + "observations/range_m");
    const auto landmark = log.Get<std::int32_t>("truth/" + name + "observations/landmark");
    const auto pose_time = log.Get<double>("truth/" + name + "poses/time_s");
    const auto pose_x = log.Get<double>("truth/" + name + "poses/x_m"),
               pose_y = log.Get<double>("truth/" + name + "poses/y_m");
    std::vector<double> errors;
    for (std::size_t i = 0; i < time.size(); ++i) {
      const auto at = static_cast<std::size_t>(std::lower_bound(pose_time.begin(), pose_time.end(), time[i]) -
                                               pose_time.begin());
      if (at >= pose_time.size() || pose_time[at] - time[i] > 0.05) continue;
      const auto l = static_cast<std::size_t>(landmark[i]);
      errors.push_back(std::abs(std::hypot(x[l] - pose_x[at], y[l] - pose_y[at]) - range[i]));
    }
    ASSERT_GT(errors.size(), 1000U);
    std::ranges::nth_element(errors, errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2));
    EXPECT_LT(errors[errors.size() / 2], 0.15) << name;
  }
}

TEST(ImportMrclamData, Dataset9StepsBackInTime) {
  if (DataFolder().empty()) GTEST_SKIP() << "CAIRN_DATA is not set";
  const std::string folder = DataFolder() + "/mrclam9";
  Blob log;
  ExpectContains(InputErrorOf([&] { ImportMrclam({folder, false, false, {}, false}, &log); }),
                 "Robot1_Odometry.dat.gz:6: time runs backwards: 1288971814.520000 after 1288971814.620000");
  const ImportReport report = ImportMrclam({folder, true, false, {}, false}, &log);
  EXPECT_GE(report.skipped.at("time runs backwards"), 4);
  EXPECT_LE(report.skipped.at("time runs backwards"), 8);
  EXPECT_NEAR(DrivenM(log, 0), 294.9, 0.1);
}

}  // namespace
}  // namespace cairn::datasets
