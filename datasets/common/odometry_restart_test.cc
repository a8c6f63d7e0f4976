#include "datasets/common/odometry_restart.h"

#include <cmath>

#include "datasets/import/csv.h"
#include "datasets/testing.h"
#include "schema/geometry.h"

namespace cairn::datasets {
namespace {

struct DrivenTrack {
  std::vector<double> time_s, x_m, y_m, heading_rad;
  std::optional<UnitDoubt> Doubt() const { return DoubtRestart(time_s, x_m, y_m, heading_rad); }
};

// A robot that drives at 0.5 m/s around a circle of 5 m, a row each 0.1 s for 40 s; from row `at` on its
// poses count from `x_m` along x, and rows come `pause_s` later.
DrivenTrack RestartedTrack(std::size_t at, double x_m, double pause_s = 0) {
  DrivenTrack track;
  for (std::size_t i = 0; i < 400; ++i) {
    const bool after = i >= at;
    const double way_m = 0.05 * static_cast<double>(after ? i - at : i), angle = way_m / 5;
    track.time_s.push_back(0.1 * static_cast<double>(i) + (after ? pause_s : 0));
    track.x_m.push_back(5 * std::sin(angle) + (after ? x_m : 0));
    track.y_m.push_back(5 - 5 * std::cos(angle));
    track.heading_rad.push_back(WrapAngle(angle));
  }
  return track;
}

TEST(OdometryRestart, ToWhereItBeganIsNamedWithRowAndTime) {
  EXPECT_FALSE(RestartedTrack(400, 0).Doubt()) << "it drives on";
  const auto now = RestartedTrack(200, 0).Doubt();
  ASSERT_TRUE(now);
  EXPECT_EQ(now->row, 200U);
  EXPECT_NEAR(now->time_s, 20, 1e-9);
  ExpectContains(now->text,
                 "odometry goes 8.39 m within 0.1 s, to where it began: was its driver started anew");
  const auto paused = RestartedTrack(200, 0, 40).Doubt();
  ASSERT_TRUE(paused) << "slow enough, but to the very place";
  ExpectContains(paused->text, "within 40.1 s, to where it began");
}

TEST(OdometryRestart, SomewhereElseTakesMoreThanAPauseExplains) {
  const auto elsewhere = RestartedTrack(200, -4).Doubt();
  ASSERT_TRUE(elsewhere);
  ExpectContains(elsewhere->text, "where 0.5 m/s is usual");
  EXPECT_FALSE(RestartedTrack(200, -4, 40).Doubt()) << "a robot drives so far in that time";
  DrivenTrack odd = RestartedTrack(400, 0);
  odd.x_m[200] += 20;
  EXPECT_FALSE(odd.Doubt()) << "one odd row, which the next takes back";
  DrivenTrack stalled = RestartedTrack(400, 0);
  for (std::size_t i = 200; i < 220; ++i) {  // its poses wait for 2 s, and come all at once
    stalled.x_m[i] = stalled.x_m[199];
    stalled.y_m[i] = stalled.y_m[199];
  }
  EXPECT_FALSE(stalled.Doubt());
}

class RestartedCsv : public ImportTest {};

TEST_F(RestartedCsv, IsAskedAboutWithTheLineAndByOtherCommandsToo) {
  for (const double pause_s : {0.0, 40.0}) {
    const DrivenTrack track = RestartedTrack(200, 0, pause_s);
    std::string odometry = "time_s,x_m,y_m,heading_rad\n";
    for (std::size_t i = 0; i < track.time_s.size(); ++i) {
      char line[128];
      std::snprintf(line, sizeof line, "%.1f,%.5f,%.5f,%.5f\n", track.time_s[i], track.x_m[i], track.y_m[i],
                    track.heading_rad[i]);
      odometry += line;
    }
    CsvImportOptions options;
    options.odometry = folder_.Put("odometry.csv", odometry);
    const ImportReport report = ImportCsv(options, &log_);
    ASSERT_EQ(report.unit_doubts.size(), 1U);
    ExpectContains(report.unit_doubts[0], "odometry.csv:202: robot 'robot', row 201 of its odometry (");
    const std::vector<std::string> of_log = FindUnitDoubts(log_);
    ASSERT_EQ(of_log.size(), 1U);
    ExpectContains(of_log[0], "to where it began: was its driver started anew");
  }
}

}  // namespace
}  // namespace cairn::datasets
