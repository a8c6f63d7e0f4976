#include "datasets/import/step_arcs.h"

#include <algorithm>
#include <cmath>

#include "datasets/import/testing_csv.h"
#include "schema/geometry.h"

namespace cairn::datasets {
namespace {

constexpr char kQuarterCircle[] =
    "time_s,turn_rad,forward_m\n0,0,0\n1,1.5707963267948966,1.5707963267948966\n2,0,1\n3,1,0\n";

class StepArcs : public ImportCsvTest {
 protected:
  void SetUp() override {
    options_.odometry = folder_.Put("odometry.csv", kQuarterCircle);
    options_.steps_are_arcs = true;
  }
};

TEST_F(StepArcs, HalfOfTheTurnComesBeforeTheChordAndHalfAfter) {
  options_.odometry = folder_.Put("o.csv", "time_s,turn_rad,forward_m\n0,0,0\n1,0.04,2\n2,0,1\n3,0.03,0\n");
  Import();
  EXPECT_EQ(Column<double>("robot/0/odometry/time_s"), (std::vector<double>{0, 1, 1, 2, 3}));
  EXPECT_EQ(Column<double>("robot/0/odometry/turn_rad"), (std::vector<double>{0, 0.02, 0.02, 0, 0.03}));
  const std::vector<double> way = Column<double>("robot/0/odometry/forward_m");
  EXPECT_NEAR(way[1], 2 * std::sin(0.02) / 0.02, 1e-12);
  EXPECT_EQ((std::vector<double>{way[0], way[2], way[3], way[4]}), (std::vector<double>{0, 0, 1, 0}));
}

// Of a circle of radius 1 about (0, 1), at each row's time.
TEST_F(StepArcs, AWideArcIsCutIntoPiecesOfItsTime) {
  Import();
  const std::vector<double> time_s = Column<double>("robot/0/odometry/time_s"),
                            turn = Column<double>("robot/0/odometry/turn_rad"),
                            way = Column<double>("robot/0/odometry/forward_m");
  Pose pose;
  std::size_t rows = 0;
  for (std::size_t i = 0; i < time_s.size() && time_s[i] <= 1; ++i) {
    pose = Compose(Compose(pose, {0, 0, turn[i]}), {way[i], 0, 0});
    EXPECT_LE(std::abs(turn[i]), 0.025);
    if (i + 1 < time_s.size() && time_s[i + 1] == time_s[i]) continue;
    EXPECT_NEAR(pose.heading_rad, time_s[i] * M_PI / 2, 1e-12);
    EXPECT_NEAR(pose.x_m, std::sin(pose.heading_rad), 1e-12);
    EXPECT_NEAR(pose.y_m, 1 - std::cos(pose.heading_rad), 1e-12);
    ++rows;
  }
  EXPECT_EQ(rows, 1u + 32u);
  EXPECT_TRUE(std::ranges::is_sorted(time_s));
  EXPECT_EQ(time_s.back(), 3);
}

TEST_F(StepArcs, WithoutBeingToldRowsStayAsTheyAre) {
  options_.steps_are_arcs = false;
  Import();
  EXPECT_EQ(Column<double>("robot/0/odometry/turn_rad"), (std::vector<double>{0, M_PI / 2, 0, 1}));
  EXPECT_EQ(Column<double>("robot/0/odometry/forward_m"), (std::vector<double>{0, M_PI / 2, 1, 0}));
}

TEST_F(StepArcs, LongOnesAreAWarningUnlessTheyAreSaidToBeArcs) {
  std::string rows = "time_s,turn_rad,forward_m\n";
  for (int i = 0; i < 30; ++i) rows += std::to_string(i) + "," + (i % 2 == 0 ? "0.2" : "-0.2") + ",0.8\n";
  options_.odometry = folder_.Put("odometry.csv", rows);
  for (const std::string& warning : Import().warnings)
    EXPECT_EQ(warning.find("--steps-are-arcs"), std::string::npos) << warning;
  options_.steps_are_arcs = false;
  const ImportReport report = Import();
  ASSERT_FALSE(report.warnings.empty());
  ExpectContains(report.warnings.front(),
                 "odometry.csv: robot 'robot': its rows turn and go at once, some 0.8 m");
  ExpectContains(report.warnings.front(), "say --steps-are-arcs");
}

TEST_F(StepArcs, WhatIsNoStepIsRefused) {
  options_.odometry = folder_.Put("v.csv", "time_s,v_mps,omega_radps\n0,1,1\n1,1,1\n");
  ExpectContains(Failure(), "v.csv: --steps-are-arcs is of rows turn_rad,forward_m");
}

TEST_F(StepArcs, WhatIsInDoubtIsNamedByItsOwnLine) {
  options_.odometry =
      folder_.Put("odometry.csv", "time_s,turn_rad,forward_m\n0,0,0\n1,0.1,1\n2,0.1,1\n3,0.1,500\n");
  const ImportReport report = Import();
  ASSERT_FALSE(report.unit_doubts.empty());
  ExpectContains(report.unit_doubts.front(), "odometry.csv:5: ");
}

}  // namespace
}  // namespace cairn::datasets
