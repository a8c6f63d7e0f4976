#include "datasets/verdicts/wall_turns.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "datasets/verdicts/local_map_verdict.h"
#include "schema/rng.h"

namespace cairn::datasets {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

// A robot goes round a rectangle of 30 by 20 m `laps` times, or `back` and forth. Its path has all turns at
// right angles; odometry says `bend_rad` more of each corner, or of one only.
struct Rounds {
  int laps = 3;
  double bend_rad = 0, drift_rad_per_m = 0.005, walk_rad = 0.01;
  bool one_corner = false;
  bool in_middle = false;  // of a side, not at its end: the path drives straight on
  double step_m = 0.25;    // 0.05: the sides are of 6 by 4 m

  kinds::LocalMap::Robot Make() const {
    Rng rng(3);
    std::vector<double> time_s, angle, strength;
    std::vector<std::uint8_t> locked, other;
    std::vector<Pose> poses;
    Pose pose;
    double walls = 0.3;
    for (int side = 0; side < 4 * laps; ++side) {
      const int steps = side % 2 == 0 ? 120 : 80;
      const double bend = one_corner && side % 4 != 1 ? 0 : bend_rad;
      for (int k = 0; k < steps; ++k) {
        pose.x_m += step_m * std::cos(pose.heading_rad);
        pose.y_m += step_m * std::sin(pose.heading_rad);
        if (in_middle && k == steps / 2) walls += bend;
        walls += drift_rad_per_m * step_m + walk_rad * std::sqrt(step_m) * rng.Normal();
        poses.push_back(pose);
        time_s.push_back(static_cast<double>(time_s.size()));
        angle.push_back(walls - std::floor(walls / (std::numbers::pi / 2)) * (std::numbers::pi / 2));
        strength.push_back(1);
        locked.push_back(1);
        other.push_back(0);
      }
      if (!in_middle) walls += bend;
      pose.heading_rad = WrapAngle(pose.heading_rad + std::numbers::pi / 2);
    }
    kinds::LocalMap::Robot robot;
    robot.poses.Set(time_s, poses);
    robot.walls.time_s = time_s;
    robot.walls.angle_rad = angle;
    robot.walls.strength = strength;
    robot.walls.locked = locked;
    robot.walls.other_area = other;
    return robot;
  }
};

TEST(FindWallTurns, OdometrysDriftIsNoTurnOfTheWalls) {
  const WallTurns turns = FindWallTurns(Rounds{}.Make());
  EXPECT_NEAR(turns.path_m, 300, 1);
  EXPECT_NEAR(turns.turn_scale, 0, 0.02);
  EXPECT_NEAR(turns.sd_rad, 0.01 * std::sqrt(2), 0.004);
  EXPECT_LT(turns.rms_rad, 1.5 * turns.sd_rad);
  EXPECT_GT(turns.pairs, 200U);
  EXPECT_LT(turns.alike, 0.3);
  EXPECT_EQ(turns.other_share, 0);
  EXPECT_EQ(FindWallTurns({}).path_m, 0);
}

// A shuttle in a corridor: its odometry drifts, and nothing tells of turns.
TEST(FindWallTurns, ARobotThatNeverTurnsTellsNoScaleOfTurns) {
  kinds::LocalMap::Robot robot = Rounds{.drift_rad_per_m = 0.01, .walk_rad = 0.02}.Make();
  robot.poses.heading_rad = std::vector<double>(robot.poses.time_s.vector().size(), 0);
  const WallTurns turns = FindWallTurns(robot);
  EXPECT_EQ(turns.turn_scale, 0);
  EXPECT_NEAR(turns.drift_rad, 3, 1);
  EXPECT_NEAR(turns.rms_rad, 0.02 * std::sqrt(2), 0.01);
}

// A triangle's corners are all alike, and look as if odometry made too much of each turn; those of an
// irregular building are not.
TEST(FindWallTurns, CornersThatAreNotRightAnglesShow) {
  const WallTurns all = FindWallTurns(Rounds{.bend_rad = 30 * kDegree}.Make());
  EXPECT_NEAR(all.turn_scale, 0.25, 0.02);
  EXPECT_GT(all.alike, 0.6);
  const WallTurns one =
      FindWallTurns(Rounds{.bend_rad = 30 * kDegree, .walk_rad = 0.005, .one_corner = true}.Make());
  EXPECT_GT(one.rms_rad, 4 * one.sd_rad);
  EXPECT_GT(one.alike_rad, 2 * kDegree);
  const WallTurns little = FindWallTurns(Rounds{.bend_rad = 10 * kDegree, .one_corner = true}.Make());
  EXPECT_GT(little.alike, 0.5);
  EXPECT_GT(little.alike_rad, 1 * kDegree);
}

// All steps go to one side, and soon after each other: the drift that fits best takes off a part of each, and
// leaves the rest of the way off by as much.
TEST(FindWallTurns, StepsThatLookLikeDriftStandOut) {
  const WallTurns turns = FindWallTurns(Rounds{
      .bend_rad = 40 * kDegree, .walk_rad = 0.005, .one_corner = true, .in_middle = true, .step_m = 0.05}
                                            .Make());
  EXPECT_LT(turns.sd_rad, 0.02);  // the walk alone: 0.007
  EXPECT_GT(turns.rms_rad, 4 * turns.sd_rad);
  EXPECT_GT(turns.rms_rad, 5 * kDegree);
}

// One corner of three rounds, and all of them.
TEST(FindWallTurns, PlacesAreCountedAtEachPass) {
  EXPECT_EQ(FindWallTurns(Rounds{}.Make()).places, 0U);
  const WallTurns one = FindWallTurns(Rounds{.bend_rad = 30 * kDegree, .one_corner = true}.Make());
  EXPECT_EQ(one.places, 3U);
  EXPECT_NEAR(one.place_rad, 30 * kDegree, 3 * kDegree);
  const WallTurns all = FindWallTurns(Rounds{.bend_rad = 30 * kDegree}.Make());
  EXPECT_EQ(all.places, 11U);  // the last corner has no window after it
  EXPECT_NEAR(all.place_rad, 30 * kDegree, 5 * kDegree);
}

// Of a map whose path closes a hundred loops.
std::string VerdictOf(const Rounds& rounds) {
  kinds::LocalMap map;
  map.robots = std::vector<std::string>{"robot"};
  map.robot = {rounds.Make()};
  map.traces.robot = std::vector<std::int32_t>{0};
  map.connections.from = map.connections.to = std::vector<std::int32_t>(100, 0);
  map.connections.kind = std::vector<std::int32_t>(100, 2);
  map.connections.from_s = std::vector<double>(100, 0);
  map.connections.to_s = std::vector<double>(100, map.robot[0].walls.time_s.vector().back());
  map.connections.used = std::vector<std::uint8_t>(100, 1);
  return LocalMapVerdict(BlobOf(map)).Text();
}

TEST(LocalMapVerdict, WallsThatDoNotStandAtRightAnglesAreNamed) {
  EXPECT_EQ(VerdictOf({}), "high: the path closes all of 100 loops");
  EXPECT_EQ(VerdictOf({.bend_rad = 30 * kDegree, .walk_rad = 0.002, .one_corner = true}),
            "low: the path closes all of 100 loops; walls were taken to stand at right angles, but 3 times "
            "odometry turns by 30 degrees otherwise");
  EXPECT_TRUE(VerdictOf({.bend_rad = 30 * kDegree}).starts_with("low: "));
  EXPECT_TRUE(VerdictOf({.bend_rad = 10 * kDegree, .one_corner = true}).starts_with("low: "));
}

// An error of odometry comes once, and not again where the robot passes the place again.
TEST(FindWallTurns, ASlipIsNotAlikeFromPassToPass) {
  kinds::LocalMap::Robot robot = Rounds{}.Make();
  auto angle = robot.walls.angle_rad.vector();
  for (std::size_t i = 500; i < angle.size(); ++i)
    angle[i] = std::fmod(angle[i] + 10 * kDegree, std::numbers::pi / 2);
  robot.walls.angle_rad = angle;
  EXPECT_LT(FindWallTurns(robot).alike, 0.3);
}

// What the scans themselves show of a turn that odometry missed says nothing of how walls stand.
TEST(FindWallTurns, ATurnThatOdometryIsKnownToHaveMissedIsLeftOut) {
  kinds::LocalMap::Robot robot = Rounds{}.Make();
  auto angle = robot.walls.angle_rad.vector();
  for (std::size_t i = 500; i < angle.size(); ++i)
    angle[i] = std::fmod(angle[i] + 40 * kDegree, std::numbers::pi / 2);
  robot.walls.angle_rad = angle;
  EXPECT_EQ(FindWallTurns(robot).places, 1U);
  const std::vector<double> from_s{499}, until_s{501}, quarter{std::numbers::pi / 2}, none{0};
  robot.fit = {from_s, until_s, quarter, none, quarter, none, none, std::vector<std::uint8_t>{0}};
  EXPECT_EQ(FindWallTurns(robot).places, 0U);
}

}  // namespace
}  // namespace cairn::datasets
