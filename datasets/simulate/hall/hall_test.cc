#include "datasets/simulate/hall/hall.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

#include "datasets/simulate/echo.h"
#include "datasets/simulate/sonar.h"
#include "datasets/simulate/testing_beams.h"

namespace cairn::datasets {
namespace {

constexpr double kNoise = 5 * kSonarSdM;
// How far beyond the wall the axis of a slanting beam is where the cone's edge meets a post.
constexpr double kPostsM = 0.4;

std::vector<Reading> HallReadings(const Blob& log) { return ReadingsOf(log, "sonar", "robot/0/poses/"); }

double AboveM(const Blob& log) { return log.Get<double>("truth/doors/y_m")[0]; }

// Shares nothing with the simulator: the nearest of points every 4 mm along the walls.
double NearestPointM(const std::vector<Wall>& walls, const Reading& reading) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Wall& wall : walls) {
    const int steps = static_cast<int>(DistanceM(wall.a, wall.b) / 0.004) + 1;
    for (int i = 0; i <= steps; ++i) {
      const double t = static_cast<double>(i) / steps;
      const Point to{wall.a.x_m + t * (wall.b.x_m - wall.a.x_m) - reading.from.x_m,
                     wall.a.y_m + t * (wall.b.y_m - wall.a.y_m) - reading.from.y_m};
      const double off = WrapAngle(std::atan2(to.y_m, to.x_m) - reading.heading_rad);
      if (std::abs(off) <= kSonarOpeningRad / 2) nearest = std::min(nearest, std::hypot(to.x_m, to.y_m));
    }
  }
  return nearest;
}

TEST(SimulateHallway, AsManyReadingsAsAskedForGetThroughTheDoor) {
  for (const int readings : {1, 3, 16}) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const Blob log = SimulateHallway({.door_readings = readings, .closed = false, .seed = seed});
      int through = 0;
      for (const Reading& reading : HallReadings(log)) {
        if (std::isnan(reading.range_m)) continue;
        const double beyond_m = reading.End().y_m - AboveM(log);
        const bool beyond = beyond_m > 0.5;
        through += beyond ? 1 : 0;
        EXPECT_TRUE(beyond || beyond_m < kPostsM) << "seed " << seed << ": " << beyond_m;
      }
      EXPECT_EQ(through, readings) << "seed " << seed;
      EXPECT_EQ(log.at("robot/0/sonar/range_m").size(), 1800);
    }
  }
}

TEST(SimulateHallway, EveryEchoIsOfTheNearestWallInItsCone) {
  const Blob log = SimulateHallway({.door_readings = 3, .closed = false, .seed = 1});
  const std::vector<Wall> walls = SegmentsOf(log, "truth/walls/");
  int heard = 0, silent_for_no_reason = 0;
  for (const Reading& reading : HallReadings(log)) {
    const double nearest_m = NearestPointM(walls, reading);
    if (std::isnan(reading.range_m)) {
      if (nearest_m < kSonarMaxRangeM - kNoise) ++silent_for_no_reason;
      continue;
    }
    ++heard;
    EXPECT_NEAR(reading.range_m, nearest_m, kNoise);
  }
  EXPECT_GT(heard, 1500);
  EXPECT_NEAR(silent_for_no_reason / 1800.0, kSonarDropouts, 0.015);
}

TEST(SimulateHallway, ClosedIsTheSameHallWithADoorInItsOpening) {
  const Blob open = SimulateHallway({.door_readings = 16, .closed = false, .seed = 4});
  const Blob closed = SimulateHallway({.door_readings = 16, .closed = true, .seed = 4});
  EXPECT_EQ(SegmentsOf(closed, "truth/walls/").size(), SegmentsOf(open, "truth/walls/").size() + 1);
  EXPECT_EQ(open.Get<std::uint8_t>("truth/doors/open")[0], 1);
  EXPECT_EQ(closed.Get<std::uint8_t>("truth/doors/open")[0], 0);
  for (const char* same : {"robot/0/poses/", "robot/0/odometry/", "truth/doors/x_m"})
    EXPECT_EQ(open.Sub(same).ContentHash(), closed.Sub(same).ContentHash()) << same;
  const std::vector<Reading> a = HallReadings(open), b = HallReadings(closed);
  int changed = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_TRUE(std::isnan(b[i].range_m) || b[i].End().y_m - AboveM(closed) < kNoise);
    if (a[i].range_m == b[i].range_m || (std::isnan(a[i].range_m) && std::isnan(b[i].range_m))) continue;
    ++changed;
    EXPECT_TRUE(b[i].range_m < a[i].range_m || std::isnan(b[i].range_m));  // the leaf is nearer, or was lost
  }
  EXPECT_GE(changed, 16);
}

// Published results name seeds. Made by this test itself.
TEST(SimulateHallway, OneSeedGivesOneLogForEver) {
  const std::map<int, std::string> hashes{{1, "10eeebfc77950616ed194d7c9b64a41d"},
                                          {3, "e0224aafbdd89b3fbd6052f1e61a0799"},
                                          {16, "b4df0b56554e655127c35c520f5d2845"}};
  for (const auto& [readings, hash] : hashes)
    EXPECT_EQ(SimulateHallway({.door_readings = readings, .closed = false, .seed = 101}).ContentHash().Hex(),
              hash);
}

TEST(SimulateHallway, RefusesWhatNoDoorCanDo) {
  for (const int readings : {0, 25})
    EXPECT_THROW(SimulateHallway({.door_readings = readings, .closed = false, .seed = 1}), InputError);
}

// Most of what is sent at the smooth wall comes back late or not at all; what faces it comes back right.
TEST(SimulateSmoothWall, ThrowsOnMostSoundThatDoesNotFaceIt) {
  const Blob log = SimulateSmoothWall(1);
  const std::vector<Wall> walls = SegmentsOf(log, "truth/walls/");
  const auto smooth = log.Get<std::uint8_t>("truth/walls/smooth");
  ASSERT_EQ(smooth.size(), walls.size());
  ASSERT_EQ(smooth[0], 1);
  EXPECT_GE(DistanceM(walls[0].a, walls[0].b), 50);
  int facing = 0, oblique = 0, wrong_facing = 0, right_oblique = 0;
  for (const Reading& reading : HallReadings(log)) {
    if (reading.cause == static_cast<int>(Cause::kPerson)) continue;
    const double axis_m = NearestWallM({walls[0]}, reading.from, reading.heading_rad, 0);
    if (axis_m > 3) continue;
    const double foot_m = reading.from.y_m - walls[0].a.y_m;
    const bool faces = std::acos(foot_m / axis_m) < kSonarOpeningRad / 2;
    const double nearest_m =
        NearestWallM({walls[0]}, reading.from, reading.heading_rad, kSonarOpeningRad / 2);
    const bool right = std::abs(reading.range_m - (faces ? foot_m : nearest_m)) < kNoise;
    ++(faces ? facing : oblique);
    if (faces && !right && !std::isnan(reading.range_m)) ++wrong_facing;
    if (!faces && right) ++right_oblique;
  }
  EXPECT_GT(facing, 250);
  EXPECT_GT(oblique, 4 * facing);
  EXPECT_EQ(wrong_facing, 0);
  EXPECT_NEAR(right_oblique, kMirrorAnswers * oblique, 0.05 * oblique);
}

TEST(SimulateSmoothWall, SomebodyWalksBehindTheRobotAllTheWay) {
  const Blob log = SimulateSmoothWall(2);
  const auto x = log.Get<double>("truth/person/x_m"), y = log.Get<double>("truth/person/y_m"),
             robot_x = log.Get<double>("robot/0/poses/x_m");
  const std::vector<Reading> readings = HallReadings(log);
  ASSERT_EQ(x.size() + 1, robot_x.size());
  std::size_t of_person = 0;
  for (std::size_t i = 0; i < readings.size(); ++i) {
    const std::size_t scan = i / kSonars;
    EXPECT_LT(x[scan], robot_x[scan + 1] - 0.9);
    if (readings[i].cause != static_cast<int>(Cause::kPerson)) continue;
    ++of_person;
    const double off_m = DistanceM(readings[i].from, {x[scan], y[scan]}) - readings[i].range_m;
    EXPECT_NEAR(off_m, kPersonRadiusM, 0.15 + kNoise);
  }
  EXPECT_GT(of_person, x.size());
}

TEST(SimulateNarrowDoors, TwoNarrowDoorsAreSeenThroughAndSomebodyPasses) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Blob log = SimulateNarrowDoors(seed);
    const std::vector<Wall> doors = SegmentsOf(log, "truth/doors/");
    ASSERT_EQ(doors.size(), 2U);
    std::map<std::size_t, int> through;
    int of_person = 0;
    for (const Reading& reading : HallReadings(log)) {
      if (reading.cause == static_cast<int>(Cause::kPerson)) ++of_person;
      if (reading.cause != static_cast<int>(Cause::kBeyondDoor)) continue;
      const double share = (AboveM(log) - reading.from.y_m) / (reading.End().y_m - reading.from.y_m);
      const double at = reading.from.x_m + share * (reading.End().x_m - reading.from.x_m);
      for (std::size_t door = 0; door < doors.size(); ++door)
        if (at > doors[door].a.x_m && at < doors[door].b.x_m) ++through[door];
    }
    EXPECT_GT(of_person, 20) << seed;
    for (std::size_t door = 0; door < doors.size(); ++door) {
      EXPECT_LE(DistanceM(doors[door].a, doors[door].b), 0.75);
      EXPECT_GE(through[door], 1) << "seed " << seed << ", door " << door;
    }
  }
}

}  // namespace
}  // namespace cairn::datasets
