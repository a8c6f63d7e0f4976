#include "datasets/simulate/office/office.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "datasets/simulate/echo.h"
#include "datasets/simulate/loop.h"
#include "datasets/simulate/testing_beams.h"

namespace cairn::datasets {
namespace {

constexpr double kNoiseM = 5 * kSonarSdM;
constexpr double kRobotM = 0.3;

const Blob& Office() {
  static const Blob log = SimulateOffice({.seed = 1});
  return log;
}

struct Standing {
  std::vector<Wall> walls;
  std::vector<double> from_s, until_s;
  std::vector<std::uint8_t> smooth;
};

Standing WallsOfLog(const Blob& log) {
  const auto from = log.Get<double>("truth/walls/from_s"), until = log.Get<double>("truth/walls/until_s");
  const auto smooth = log.Get<std::uint8_t>("truth/walls/smooth");
  return {SegmentsOf(log, "truth/walls/"),
          {from.begin(), from.end()},
          {until.begin(), until.end()},
          {smooth.begin(), smooth.end()}};
}

std::vector<Wall> At(const Standing& all, double time_s) {
  std::vector<Wall> walls;
  for (std::size_t i = 0; i < all.walls.size(); ++i)
    if (all.from_s[i] <= time_s && time_s < all.until_s[i]) walls.push_back(all.walls[i]);
  return walls;
}

double DistanceToM(const std::vector<Wall>& walls, Point at) {
  double nearest_m = std::numeric_limits<double>::infinity();
  // Five cones all round.
  for (const double heading : {0.0, 1.3, 2.6, 3.9, 5.2})
    nearest_m = std::min(nearest_m, NearestWallM(walls, at, heading, 0.7));
  return nearest_m;
}

struct Path {
  std::vector<Point> at;
  std::vector<double> heading_rad, time_s;
};
Path TruePath(const Blob& log) {
  const auto x = log.Get<double>("truth/robot/0/poses/x_m"), y = log.Get<double>("truth/robot/0/poses/y_m");
  const auto heading = log.Get<double>("truth/robot/0/poses/heading_rad"),
             time = log.Get<double>("truth/robot/0/poses/time_s");
  Path path;
  for (std::size_t i = 0; i < x.size(); ++i) path.at.push_back({x[i], y[i]});
  path.heading_rad.assign(heading.begin(), heading.end());
  path.time_s.assign(time.begin(), time.end());
  return path;
}

TEST(SimulateOffice, TheRobotNeverTouchesAWallOrFurnitureBeforeOrAfterItMoves) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Blob log = SimulateOffice({.minutes = 12, .moved = true, .turned = seed % 2 == 0, .seed = seed});
    const Standing walls = WallsOfLog(log);
    const Path path = TruePath(log);
    ASSERT_EQ(path.at.size(), 3601U);
    for (std::size_t i = 0; i < path.at.size(); i += 3)
      ASSERT_GT(DistanceToM(At(walls, path.time_s[i]), path.at[i]), kRobotM)
          << seed << ", " << path.time_s[i];
  }
}

// Shares nothing with how the simulator casts: the reading's end lies on a wall, but where sound was thrown
// on.
TEST(SimulateOffice, EchoesOfWallsEndWithinTheConeAtAWallAndOthersAreFalse) {
  const Standing walls = WallsOfLog(Office());
  std::size_t of_walls = 0, mirrored = 0, lost = 0, of_persons = 0;
  const std::vector<Reading> readings = ReadingsOf(Office(), "sonar", "truth/robot/0/poses/");
  ASSERT_EQ(readings.size(), 3000U * 24);
  for (const Reading& reading : readings) {
    switch (static_cast<Cause>(reading.cause)) {
      case Cause::kNothing:
        ++lost;
        EXPECT_TRUE(std::isnan(reading.range_m));
        break;
      case Cause::kPerson:
        ++of_persons;
        break;
      case Cause::kMirror:
        ++mirrored;
        break;
      default: {
        ++of_walls;
        bool there = false;
        for (const Wall& wall : walls.walls) {
          const auto at = Cone(reading.from, reading.heading_rad, 0.4363 / 2).Nearest(wall);
          there = there || (at && std::abs(DistanceM({}, *at) - reading.range_m) < kNoiseM);
        }
        EXPECT_TRUE(there) << reading.time_s << " s";
      }
    }
  }
  EXPECT_GT(of_walls, readings.size() / 2);
  EXPECT_GT(mirrored, readings.size() / 50);
  EXPECT_GT(lost, readings.size() / 20);
  EXPECT_GT(of_persons, readings.size() / 500);
}

TEST(SimulateOffice, MostEchoesFromMetalThatIsNotFacedAreFalseOrMissing) {
  const Standing walls = WallsOfLog(Office());
  std::vector<Wall> metal;
  for (std::size_t i = 0; i < walls.walls.size(); ++i)
    if (walls.smooth[i]) metal.push_back(walls.walls[i]);
  int oblique = 0, right = 0;
  for (const Reading& reading : ReadingsOf(Office(), "sonar", "truth/robot/0/poses/")) {
    const double axis_m = NearestWallM(metal, reading.from, reading.heading_rad, 0);
    if (axis_m > NearestWallM(walls.walls, reading.from, reading.heading_rad, 0.25) * 1.3 || axis_m > 3)
      continue;
    const double nearest_m = DistanceToM(metal, reading.from);
    if (nearest_m > axis_m * std::cos(0.4)) continue;  // faced
    ++oblique;
    right += reading.cause == static_cast<int>(Cause::kWall) ? 1 : 0;
  }
  EXPECT_GT(oblique, 2000);
  EXPECT_LT(right, 0.6 * oblique);
}

TEST(SimulateOffice, InfraredIsShortAndKnowsNoMirrors) {
  const std::vector<Reading> readings = ReadingsOf(Office(), "infrared", "truth/robot/0/poses/");
  ASSERT_EQ(readings.size(), 3000U * 16);
  const Standing walls = WallsOfLog(Office());
  int answered = 0;
  for (const Reading& reading : readings) {
    EXPECT_NE(reading.cause, static_cast<int>(Cause::kMirror));
    if (reading.cause != static_cast<int>(Cause::kWall)) continue;
    ++answered;
    EXPECT_LE(reading.range_m, 0.8);
    EXPECT_NEAR(reading.range_m, NearestWallM(walls.walls, reading.from, reading.heading_rad, 0), 0.1);
  }
  EXPECT_GT(answered, 3000);
}

TEST(SimulateOffice, DrivesStraightOnAlongTheWallsAndTurnsOnTheSpot) {
  const Path path = TruePath(Office());
  double along_m = 0, aslant_m = 0;
  for (std::size_t i = 1; i < path.at.size(); ++i) {
    const double distance_m = DistanceM(path.at[i - 1], path.at[i]);
    const bool turned = path.heading_rad[i] != path.heading_rad[i - 1];
    EXPECT_FALSE(turned && distance_m > 1e-5) << path.time_s[i];
    const double off = std::remainder(path.heading_rad[i], std::numbers::pi / 2);
    (std::abs(off) < 0.12 ? along_m : aslant_m) += distance_m;
  }
  EXPECT_GT(along_m, 120);
  EXPECT_LT(aslant_m, 0.05 * along_m);
}

// So that there are loops to close: from every room that it was in the robot comes back later.
TEST(SimulateOffice, VisitsAllRoomsMoreThanOnceInTenMinutes) {
  int twice = 0, once = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Path path = TruePath(SimulateOffice({.seed = seed}));
    std::set<std::pair<int, int>> before, again;
    std::pair<int, int> last{99, 99};
    for (const Point& at : path.at) {
      if (std::abs(at.y_m) < 2) {
        last = {99, 99};
        continue;
      }
      const std::pair<int, int> place{static_cast<int>(std::floor(at.x_m / 2)), at.y_m > 0 ? 1 : -1};
      if (place != last && !before.insert(place).second) again.insert(place);
      last = place;
    }
    once += static_cast<int>(before.size());
    twice += static_cast<int>(again.size());
  }
  EXPECT_GT(twice, 0.7 * once);
}

TEST(SimulateOffice, TheTurretSwingsAllTheTimeAndStandsStillNever) {
  const auto turret = Office().Get<double>("robot/0/sonar/turret_rad");
  ASSERT_EQ(turret.size(), 3000U);
  double low = 0, high = 0;
  for (std::size_t i = 1; i < turret.size(); ++i) {
    EXPECT_NE(turret[i], turret[i - 1]);
    EXPECT_LT(std::abs(turret[i] - turret[i - 1]), 0.11);
    low = std::min(low, turret[i]);
    high = std::max(high, turret[i]);
  }
  EXPECT_NEAR(low, -0.8, 0.1);
  EXPECT_NEAR(high, 0.8, 0.1);
}

TEST(SimulateOffice, SomebodyStandsInTheWayForHalfAMinuteAndMoreInSomeOffice) {
  int long_stops = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Blob log = SimulateOffice({.seed = seed});
    const auto forward = log.Get<double>("robot/0/odometry/forward_m");
    const auto turn = log.Get<double>("robot/0/odometry/turn_rad");
    int still = 0;
    for (std::size_t i = 0; i < forward.size(); ++i) {
      still = forward[i] == 0 && turn[i] == 0 ? still + 1 : 0;
      long_stops += still == 150 ? 1 : 0;
    }
  }
  EXPECT_GE(long_stops, 2);
}

TEST(SimulateOffice, OdometryHasTheErrorsOfLoopsOfTheSameLength) {
  double sum = 0, squares = 0;
  constexpr int kSeeds = 30;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Blob log = SimulateOffice({.persons = false, .seed = seed});
    double measured = 0, distance_m = 0;
    for (const double turn : log.Get<double>("robot/0/odometry/turn_rad")) measured += turn;
    for (const double forward : log.Get<double>("robot/0/odometry/forward_m")) distance_m += forward;
    const Path path = TruePath(log);
    const double error =
        std::remainder(measured - (path.heading_rad.back() - path.heading_rad.front()), 2 * std::numbers::pi);
    sum += error;
    squares += error * error;
    EXPECT_GT(distance_m, 120);
  }
  // 160 m: a drift of 0.06 deg/m, a walk of 0.5 deg/sqrt(m), 2% of about a hundred quarter turns in four
  // parts.
  const double drift = 0.06 * 160, walk = 0.5 * std::sqrt(160), turns = 0.02 * 90 / 2 * std::sqrt(80);
  const double expected_deg = std::sqrt(drift * drift + walk * walk + turns * turns);
  const double found_deg = std::sqrt(squares / kSeeds) * 180 / std::numbers::pi;
  EXPECT_GT(found_deg, 0.6 * expected_deg);
  EXPECT_LT(found_deg, 1.5 * expected_deg);
  EXPECT_LT(std::abs(sum / kSeeds), expected_deg * std::numbers::pi / 180 / 2);
}

TEST(SimulateOffice, HalfOfTheFurnitureStandsElsewhereAfterTheMiddle) {
  for (const std::uint64_t seed : {2, 51, 105}) {
    const Blob log = SimulateOffice({.moved = true, .seed = seed});
    const Standing walls = WallsOfLog(log);
    std::set<double> moments;
    int went = 0, came = 0, stayed = 0;
    for (std::size_t i = 0; i < walls.walls.size(); ++i) {
      went += walls.until_s[i] < 600 ? 1 : 0;
      came += walls.from_s[i] > 0 ? 1 : 0;
      stayed += walls.from_s[i] == 0 && walls.until_s[i] > 600 ? 1 : 0;
      if (walls.from_s[i] > 0) moments.insert(walls.from_s[i]);
    }
    EXPECT_GT(went, 20) << seed;
    EXPECT_GT(came, 20) << seed;
    EXPECT_GT(stayed, went) << seed;
    ASSERT_EQ(moments.size(), 1U) << seed;
    EXPECT_GT(*moments.begin(), 300) << seed;
    EXPECT_LT(*moments.begin(), 450) << seed;
  }
  EXPECT_THROW(SimulateOffice({.minutes = 1, .moved = true, .seed = 51}), InputError);
}

TEST(SimulateOffice, WallsOfTheTurnedRoomAreTurned) {
  const Blob log = SimulateOffice({.turned = true, .seed = 3});
  const auto angle = log.Get<double>("truth/robot/0/walls/angle_rad");
  const auto heading = log.Get<double>("truth/robot/0/poses/heading_rad");
  const auto forward = log.Get<double>("robot/0/odometry/forward_m");
  int turned = 0;
  for (std::size_t i = 0; i < angle.size(); ++i) {
    if (angle[i] == 0) continue;
    EXPECT_NEAR(angle[i], std::numbers::pi / 6, 1e-12);
    if (forward[i] > 0 && std::abs(std::remainder(heading[i + 1] - angle[i], std::numbers::pi / 2)) < 0.12)
      ++turned;
  }
  EXPECT_GT(turned, 50);
}

TEST(SimulateOffice, NobodyAndHintsChangeNothingElse) {
  const Blob all = SimulateOffice({.seed = 5});
  const Blob marked = SimulateOffice({.hints = true, .persons = false, .seed = 5});
  EXPECT_EQ(all.Sub("robot/0/odometry/").ContentHash(), marked.Sub("robot/0/odometry/").ContentHash());
  EXPECT_EQ(all.Sub("truth/walls/").ContentHash(), marked.Sub("truth/walls/").ContentHash());
  EXPECT_FALSE(marked.Has("truth/person/time_s"));
  EXPECT_FALSE(all.Has("robot/0/hints/time_s"));
  EXPECT_GT(marked.Get<double>("robot/0/hints/time_s").size(), 10U);
  EXPECT_GT(all.Get<double>("truth/person/time_s").size(), 300U);
}

TEST(SimulateOffice, RefusesTimesThatAreNone) {
  for (const double minutes : {0.5, 121.0, std::nan("")})
    EXPECT_THROW(SimulateOffice({.minutes = minutes}), InputError);
}

}  // namespace
}  // namespace cairn::datasets
