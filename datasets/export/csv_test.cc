#include "datasets/import/csv.h"

#include <filesystem>

#include "datasets/export/export.h"
#include "datasets/import/recorded/mrclam.h"
#include "datasets/simulate/loop.h"
#include "datasets/testing.h"
#include "datasets/testing_result.h"

namespace cairn::datasets {
namespace {

// A log that went out as CSV and came in again. Range-bearing observations and noise parameters have no place
// in CSV.
Blob ThereAndBack(const Blob& log) {
  const TestFolder folder;
  EXPECT_TRUE(ExportCsv(log, folder / "").ok());
  CsvImportOptions options;
  const auto file = [&](const std::string& name) {
    return std::filesystem::exists(folder / name) ? folder / name : std::string();
  };
  options.odometry = file("odometry.csv");
  options.observations = file("observations.csv");
  options.truth_poses = file("truth_poses.csv");
  options.truth_landmarks = file("truth_landmarks.csv");
  options.truth_associations = file("truth_associations.csv");
  Blob back;
  ImportCsv(options, &back);
  return back;
}

void ExpectSame(const Blob& back, const Blob& log) {
  std::size_t compared = 0;
  for (const auto& [name, array] : log.fields()) {
    if (name.starts_with("noise/") || name.starts_with("sensor/") ||
        name.find("/robot_observations/") != std::string::npos)
      continue;
    ASSERT_TRUE(back.Has(name)) << name;
    EXPECT_EQ(back.at(name), array) << name;
    ++compared;
  }
  EXPECT_EQ(back.fields().size(), compared);
  EXPECT_GE(compared, 10U);
}

TEST(ExportCsv, ASmallLogComesBackToTheBit) { ExpectSame(ThereAndBack(SmallLog()), SmallLog()); }

TEST(ExportCsv, SimulatedLogsComeBackToTheBit) {
  for (const int robots : {1, 3}) {
    const Blob log = SimulateLoop({.difficulty = "paper", .robots = robots, .seed = 5});
    ExpectSame(ThereAndBack(log), log);
  }
}

TEST(ExportCsv, MrclamComesBackToTheBit) {
  if (DataFolder().empty()) GTEST_SKIP() << "CAIRN_DATA is not set";
  for (const bool withhold : {false, true}) {
    Blob log;
    ImportMrclam({DataFolder() + "/mrclam6", false, withhold, {}, false}, &log);
    ExpectSame(ThereAndBack(log), log);
  }
}

TEST(ExportCsv, NamesWithCommasAndQuotesAreQuoted) {
  Blob log = SmallLog();
  log.Put("robots", Array::Texts({"the \"big\" one", "a,b"}));
  ExpectSame(ThereAndBack(log), log);
  log.Put("robots", Array::Texts({"two\nlines", "a"}));
  const TestFolder folder;
  ExpectContains(InputErrorOf([&] { (void)ExportCsv(log, folder / ""); }), "a name holds a line break");
}

TEST(ExportCsv, WhatHasNoPlaceInItIsNamed) {
  Blob log = SmallLog();
  log.PutVector<double>("robot/0/laser/time_s", std::vector<double>{1});
  log.PutVector<double>("truth/walls/from_s", std::vector<double>{1});
  EXPECT_EQ(NotInCsv(log), (std::vector<std::string>{"noise", "robot/0/laser", "truth/walls"}));
  EXPECT_TRUE(NotInCsv(SmallResult()).empty());
}

TEST(ExportCsv, AResultBecomesPosesLandmarksAndAssociations) {
  const TestFolder folder;
  EXPECT_EQ(ExportCsv(SmallResult(), folder / "").value().size(), 3U);
  ExpectContains(FileText(folder / "poses.csv"),
                 "time_s,robot,x_m,y_m,heading_rad,mode_x_m,mode_y_m,mode_heading_rad\n1,Rosa,9,9,0,0,0,0\n");
  EXPECT_EQ(FileText(folder / "landmarks.csv"),
            "map_landmark,x_m,y_m,var_xx_m2,var_xy_m2,var_yy_m2,landmark,observations,label\n"
            "0,2,0,0.04,0,0.01,door,1,door\n1,1,2,0.1,0,0.1,,0.5,#1\n");
  EXPECT_EQ(FileText(folder / "associations.csv"),
            "robot,observation,map_landmark,probability\nRosa,0,0,1\nRosa,1,,0\nRosa,2,1,0.5\n");
}

TEST(ExportCsv, WhatHasNoRowsIsRefused) {
  const TestFolder folder;
  ExpectContains(InputErrorOf([&] { (void)ExportCsv(Blob({{"robots", Array::Texts({"a"})}}), folder / ""); }),
                 "neither controls nor poses");
}

}  // namespace
}  // namespace cairn::datasets
