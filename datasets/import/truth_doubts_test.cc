#include "datasets/import/truth_doubts.h"

#include <gtest/gtest.h>

#include <cmath>

#include "datasets/import/csv.h"
#include "datasets/testing.h"

namespace cairn::datasets {
namespace {

class TruthDoubtsTest : public ImportTest {
 protected:
  CsvImportOptions options_;

  // A robot that goes once around a circle of 3 m, of which it sees four landmarks.
  void SetUp() override {
    std::string odometry = "time_s,turn_rad,forward_m\n";
    std::string seen = "time_s,landmark,range_m,bearing_rad\n";
    for (int i = 0; i <= 628; ++i) odometry += std::to_string(i) + ",0.01,0.03\n";
    for (int i = 0; i < 4; ++i) seen += std::to_string(157 * i) + ",l" + std::to_string(i) + ",2,0\n";
    options_.odometry = folder_.Put("odometry.csv", odometry);
    options_.observations = folder_.Put("observations.csv", seen);
  }

  std::vector<std::string> DoubtsOf(double scale, const std::string& more = "") {
    std::string landmarks = "landmark,x_m,y_m\n" + more, poses = "time_s,x_m,y_m,heading_rad\n";
    for (int i = 0; i < 4; ++i)
      landmarks += "l" + std::to_string(i) + "," + std::to_string(500 + scale * 5 * std::cos(M_PI / 2 * i)) +
                   "," + std::to_string(scale * 5 * std::sin(M_PI / 2 * i)) + "\n";
    options_.truth_landmarks = folder_.Put("landmarks.csv", landmarks);
    const ImportReport report = ImportCsv(options_, &log_);
    EXPECT_TRUE(report.unit_doubts.empty());
    return report.warnings;
  }
};

TEST_F(TruthDoubtsTest, LandmarksThatNoRobotCanHaveReachedAreInDoubt) {
  EXPECT_TRUE(DoubtsOf(1).empty());
  EXPECT_TRUE(DoubtsOf(3.28).empty()) << "a robot could have";
  ASSERT_EQ(DoubtsOf(1000).size(), 1U);
  ExpectContains(DoubtsOf(1000).front(),
                 "true landmarks lie 5000 m from their middle, where all robots drove and "
                 "saw 22.87 m in all: are they in millimetres? Cairn reads metres");
  ExpectContains(DoubtsOf(100).front(), "are they in millimetres or centimetres?");
}

TEST_F(TruthDoubtsTest, LandmarksThatNobodySawAreNot) {
  std::string town;
  for (int i = 0; i < 50; ++i) town += "t" + std::to_string(i) + "," + std::to_string(1000 * i) + ",0\n";
  EXPECT_TRUE(DoubtsOf(1, town).empty());
  EXPECT_EQ(DoubtsOf(1000, town).size(), 1U);
}

TEST_F(TruthDoubtsTest, PosesThatNoRobotCanHaveReachedAreInDoubt) {
  std::string metres = "time_s,x_m,y_m,heading_rad\n", centimetres = metres;
  for (int i = 0; i <= 628; ++i) {
    const double x = 3 * std::sin(0.01 * i), y = 3 - 3 * std::cos(0.01 * i);
    metres += std::to_string(i) + "," + std::to_string(x) + "," + std::to_string(y) + ",0\n";
    centimetres += std::to_string(i) + "," + std::to_string(100 * x) + "," + std::to_string(100 * y) + ",0\n";
  }
  options_.truth_poses = folder_.Put("poses.csv", metres);
  EXPECT_TRUE(DoubtsOf(1).empty());
  options_.truth_poses = folder_.Put("poses.csv", centimetres);
  ASSERT_EQ(DoubtsOf(1).size(), 1U);
  ExpectContains(DoubtsOf(1).front(),
                 "true poses of robot 'robot' lie 300 m from their middle, where it drove");
}

}  // namespace
}  // namespace cairn::datasets
