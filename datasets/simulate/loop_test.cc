#include "datasets/simulate/loop.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "datasets/simulate/world.h"

namespace cairn::datasets {
namespace {

constexpr double kDeg = std::numbers::pi / 180;
constexpr std::uint64_t kSeeds = 20;

SimulateLoopOptions Options(const std::string& difficulty, std::uint64_t seed, int robots = 1) {
  return {.difficulty = difficulty, .robots = robots, .seed = seed};
}

double Sum(std::span<const double> values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum;
}

double TruePathM(const Blob& log, const std::string& robot) {
  const auto x = log.Get<double>("truth/" + robot + "/poses/x_m");
  const auto y = log.Get<double>("truth/" + robot + "/poses/y_m");
  double length = 0;
  for (std::size_t i = 1; i < x.size(); ++i) length += std::hypot(x[i] - x[i - 1], y[i] - y[i - 1]);
  return length;
}

double SegmentDistanceM(Point p, Point a, Point b) {
  const double ab_x = b.x_m - a.x_m, ab_y = b.y_m - a.y_m;
  const double along = ((p.x_m - a.x_m) * ab_x + (p.y_m - a.y_m) * ab_y) / (ab_x * ab_x + ab_y * ab_y);
  const double t = std::clamp(along, 0.0, 1.0);
  return DistanceM(p, {a.x_m + t * ab_x, a.y_m + t * ab_y});
}

struct Limits {
  double path_low_m, path_high_m, step_m, error_low_m, error_high_m;
  std::size_t contacts_low, contacts_high;
};

class EachDifficulty : public ::testing::TestWithParam<std::pair<std::string, Limits>> {};

// The table of the command's documentation, written down a second time.
INSTANTIATE_TEST_SUITE_P(
    Table, EachDifficulty,
    ::testing::Values(std::pair{std::string("paper"), Limits{330, 355, 0.13, 22, 28, 21, 24}},
                      std::pair{std::string("base"), Limits{1000, 1025, 0.33, 22, 28, 65, 70}},
                      std::pair{std::string("hard"), Limits{1000, 1025, 0.33, 45, 55, 65, 70}},
                      std::pair{std::string("extreme"), Limits{600, 640, 0.33, 60, 120, 15, 40}},
                      std::pair{std::string("museum"), Limits{735, 760, 0.275, 65, 75, 50, 50}}),
    [](const auto& param) { return param.param.first; });

TEST_P(EachDifficulty, KeepsItsRangesOverTwentySeeds) {
  const auto& [name, limits] = GetParam();
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE(seed);
    const Blob log = SimulateLoop(Options(name, seed));
    const double path = TruePathM(log, "robot/0");
    EXPECT_GE(path, limits.path_low_m - 1e-3);
    EXPECT_LE(path, limits.path_high_m);
    const double final_error = FinalOdometricErrorM(log, 0);
    EXPECT_GE(final_error, limits.error_low_m - 1e-3);
    EXPECT_LE(final_error, limits.error_high_m + 1e-3);
    const auto contacts = log.at("robot/0/observations/time_s").size();
    EXPECT_GE(contacts, static_cast<std::int64_t>(limits.contacts_low));
    EXPECT_LE(contacts, static_cast<std::int64_t>(limits.contacts_high));
    const auto controls = static_cast<double>(log.at("robot/0/odometry/time_s").size());
    EXPECT_NEAR(path / controls, limits.step_m, 0.1 * limits.step_m);
  }
}

TEST_P(EachDifficulty, PathFollowsTheCorridorsThroughTheLandmarks) {
  const double box_m = GetParam().first == "extreme" ? 150 : 90;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE(seed);
    Rng rng(seed, 0);
    const CorridorWorld world = MakeLoopWorld(box_m, rng);
    const Blob log = SimulateLoop(Options(GetParam().first, seed));
    const auto landmark_x = log.Get<double>("truth/landmarks/x_m");
    ASSERT_EQ(landmark_x.size(), world.nodes.size());
    for (std::size_t i = 0; i < landmark_x.size(); ++i) EXPECT_NEAR(landmark_x[i], world.nodes[i].x_m, 1e-6);
    const auto x = log.Get<double>("truth/robot/0/poses/x_m");
    const auto y = log.Get<double>("truth/robot/0/poses/y_m");
    double farthest = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      double nearest = 1e9;
      for (const auto& [a, b] : world.Edges()) {
        nearest = std::min(nearest, SegmentDistanceM({x[i], y[i]}, world.nodes[a], world.nodes[b]));
      }
      farthest = std::max(farthest, nearest);
    }
    EXPECT_GT(farthest, 0.1);  // nobody drives on rails
    EXPECT_LT(farthest, 2.0);
  }
}

// Mean square distance of a two-dimensional normal of sd 0.3 m an axis: 0.18 m2.
TEST_P(EachDifficulty, ContactsLieNearTheLandmarkThatTheTruthNames) {
  double squares = 0, worst = 0;
  std::size_t contacts = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Blob log = SimulateLoop(Options(GetParam().first, seed));
    const auto contact_time = log.Get<double>("robot/0/observations/time_s");
    const auto landmark = log.Get<std::int32_t>("truth/robot/0/observations/landmark");
    const auto time = log.Get<double>("truth/robot/0/poses/time_s");
    const auto x = log.Get<double>("truth/robot/0/poses/x_m");
    const auto y = log.Get<double>("truth/robot/0/poses/y_m");
    const auto landmark_x = log.Get<double>("truth/landmarks/x_m");
    const auto landmark_y = log.Get<double>("truth/landmarks/y_m");
    ASSERT_EQ(landmark.size(), contact_time.size());
    for (std::size_t i = 0; i < contact_time.size(); ++i) {
      const auto at = std::lower_bound(time.begin(), time.end(), contact_time[i]);
      ASSERT_NE(at, time.end());
      ASSERT_EQ(*at, contact_time[i]);  // a contact detection ends a control
      const auto row = static_cast<std::size_t>(at - time.begin());
      const auto l = static_cast<std::size_t>(landmark[i]);
      const double distance = std::hypot(x[row] - landmark_x[l], y[row] - landmark_y[l]);
      squares += distance * distance;
      worst = std::max(worst, distance);
      ++contacts;
    }
  }
  EXPECT_GT(contacts, 300U);
  EXPECT_NEAR(squares / static_cast<double>(contacts), 0.18, 0.03);
  EXPECT_LT(worst, 1.6);
}

TEST_P(EachDifficulty, DriveMakesNoUTurnButAtDeadEndsAndGoesRoundTheCycle) {
  const auto& limits = GetParam().second;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE(seed);
    Rng world_rng(seed, 0), rng(seed, 99);
    const CorridorWorld world = MakeLoopWorld(90, world_rng);
    DriveOptions options;
    options.min_length_m = limits.path_low_m;
    const Drive drive = DrawDrive(world, options, rng);
    std::set<std::pair<std::size_t, std::size_t>> round;
    for (std::size_t i = 1; i < drive.passes.size(); ++i) {
      const std::size_t before = drive.passes[i - 1], here = drive.passes[i];
      const auto& around = world.neighbours[here];
      EXPECT_TRUE(std::count(around.begin(), around.end(), before))
          << "no corridor " << before << "-" << here;
      if (before < world.cycle_nodes && here < world.cycle_nodes) round.insert(std::minmax(before, here));
      if (i + 1 < drive.passes.size() && drive.passes[i + 1] == before) {
        EXPECT_EQ(around.size(), 1U);
      }
    }
    EXPECT_EQ(round.size(), world.cycle_nodes);
    const std::set<std::size_t> distinct(drive.passes.begin(), drive.passes.end());
    EXPECT_LT(distinct.size(), drive.passes.size());  // revisits
  }
}

TEST_P(EachDifficulty, NominalNoiseIsAboutButNotExactlyTheSimulators) {
  const auto& difficulties = LoopDifficulties();
  const auto it = std::find_if(difficulties.begin(), difficulties.end(),
                               [](const LoopDifficulty& d) { return d.name == GetParam().first; });
  ASSERT_NE(it, difficulties.end());
  std::set<double> drifts;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Blob log = SimulateLoop(Options(GetParam().first, seed));
    const auto near = [&](const std::string& name, double exact) {
      const double nominal = log.Scalar<double>("noise/" + name);
      EXPECT_GE(nominal, 0.5 * exact) << name;
      EXPECT_LE(nominal, 1.5 * exact) << name;
      return nominal;
    };
    drifts.insert(near("heading_drift_rad_per_m", it->noise.heading_drift_rad_per_m));
    near("heading_walk_rad_per_sqrt_m", it->noise.heading_walk_rad_per_sqrt_m);
    near("forward_ratio", 0.02);
    near("turn_ratio", 0.02);
    near("contact_m", 0.3);
  }
  EXPECT_GT(drifts.size(), 1U);
}

TEST(LoopWorld, HasTwentyPlacesWellApartInsideItsBox) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE(seed);
    Rng rng(seed);
    const CorridorWorld world = MakeLoopWorld(90, rng);
    EXPECT_EQ(world.nodes.size(), 20U);
    EXPECT_EQ(world.Edges().size(), 21U);
    std::map<std::size_t, int> degrees;
    for (const auto& around : world.neighbours) ++degrees[around.size()];
    EXPECT_EQ(degrees[1], 6);  // dead ends
    EXPECT_EQ(degrees[2], 6);  // corners
    EXPECT_EQ(degrees[3], 8);  // junctions
    double round = 0;
    for (std::size_t i = 0; i < world.cycle_nodes; ++i) {
      round += DistanceM(world.nodes[i], world.nodes[(i + 1) % world.cycle_nodes]);
    }
    EXPECT_NEAR(round, 170, 5);
    for (std::size_t i = 0; i < world.nodes.size(); ++i) {
      EXPECT_TRUE(world.nodes[i].x_m > 0 && world.nodes[i].x_m < 90) << world.names[i];
      EXPECT_TRUE(world.nodes[i].y_m > 0 && world.nodes[i].y_m < 90) << world.names[i];
      for (std::size_t j = 0; j < i; ++j) EXPECT_GT(DistanceM(world.nodes[i], world.nodes[j]), 7.5);
    }
  }
}

TEST(LoopWorld, StretchesToItsBox) {
  Rng a(5), b(5);
  const CorridorWorld small = MakeLoopWorld(90, a), large = MakeLoopWorld(150, b);
  ASSERT_EQ(small.nodes.size(), large.nodes.size());
  for (std::size_t i = 0; i < small.nodes.size(); ++i) {
    EXPECT_DOUBLE_EQ(large.nodes[i].x_m, small.nodes[i].x_m * 150 / 90);
  }
}

TEST(Drive, DetectsNinetySevenOfAHundredPasses) {
  Rng world_rng(1), rng(2);
  const CorridorWorld world = MakeLoopWorld(90, world_rng);
  DriveOptions options;
  options.min_length_m = 100000;
  const Drive drive = DrawDrive(world, options, rng);
  ASSERT_GT(drive.passes.size(), 5000U);
  EXPECT_NEAR(static_cast<double>(drive.contacts.size()) / static_cast<double>(drive.passes.size()), 0.97,
              0.01);
}

// Without noise the odometry is the drive; with a drift alone every heading is off by drift times the way.
TEST(Odometry, IsTheDriveWithoutNoise) {
  Rng world_rng(1), rng(2);
  const CorridorWorld world = MakeLoopWorld(90, world_rng);
  const Drive drive = DrawDrive(world, {}, rng);
  OdometryNoise none;
  none.forward_ratio = none.turn_ratio = 0;
  const OdometryDraw draw = DrawOdometry(drive, none, {0, 0.1}, rng).value();
  ASSERT_EQ(draw.controls.size(), drive.controls.size());
  EXPECT_EQ(draw.redraws, 0);
  for (std::size_t i = 0; i < draw.controls.size(); ++i) {
    EXPECT_NEAR(draw.controls[i].turn_rad, drive.controls[i].turn_rad, 1e-6);
    EXPECT_NEAR(draw.controls[i].forward_m, drive.controls[i].forward_m, 1e-6);
  }
}

TEST(Odometry, ScalesTheDriftWhereNoFreeDrawFits) {
  Rng world_rng(1), rng(2);
  const CorridorWorld world = MakeLoopWorld(90, world_rng);
  const Drive drive = DrawDrive(world, {}, rng);
  OdometryNoise noise;
  noise.heading_drift_rad_per_m = 0.06 * kDeg;
  noise.heading_walk_rad_per_sqrt_m = 0.5 * kDeg;
  const OdometryDraw draw = DrawOdometry(drive, noise, {70, 75}, rng).value();
  EXPECT_GE(draw.redraws, 100);
  EXPECT_NE(draw.drift_factor, 1);
  EXPECT_GE(draw.final_error_m, 70);
  EXPECT_LE(draw.final_error_m, 75);
  Drive short_drive;
  short_drive.controls.assign(10, {0, 1});
  EXPECT_FALSE(DrawOdometry(short_drive, noise, {70, 75}, rng).has_value());
}

// Over many draws the increments have the moments that the noise states.
TEST(Odometry, ErrorsHaveTheirMoments) {
  Drive drive;
  drive.controls.assign(400, {0, 1});
  OdometryNoise noise;
  noise.heading_drift_rad_per_m = 0.01;
  noise.heading_walk_rad_per_sqrt_m = 0.05;
  double drift_squares = 0, walk_squares = 0, scale_squares = 0;
  constexpr int kDraws = 500;
  for (std::uint64_t seed = 0; seed < kDraws; ++seed) {
    Rng rng(seed);
    const OdometryDraw draw = DrawOdometry(drive, noise, {0, 1e9}, rng).value();
    double turn = 0, travelled = 0;
    for (const Control& c : draw.controls) {
      turn += c.turn_rad / 400;
      travelled += c.forward_m / 400;
    }
    for (const Control& c : draw.controls) walk_squares += (c.turn_rad - turn) * (c.turn_rad - turn) / 400;
    drift_squares += turn * turn;
    scale_squares += (travelled - 1) * (travelled - 1);
  }
  EXPECT_NEAR(std::sqrt(walk_squares / kDraws), 0.05, 0.001);
  EXPECT_NEAR(std::sqrt(drift_squares / kDraws), std::hypot(0.01, 0.05 / 20), 0.001);
  EXPECT_NEAR(std::sqrt(scale_squares / kDraws), 0.02, 0.002);
}

TEST(SimulateLoop, RobotsShareTheWorldAndAddNothingToEachOther) {
  const Blob one = SimulateLoop(Options("base", 7));
  const Blob three = SimulateLoop(Options("base", 7, 3));
  EXPECT_EQ(three.Texts("robots"), (std::vector<std::string>{"robot 0", "robot 1", "robot 2"}));
  EXPECT_EQ(three.Sub("robot/0/").ContentHash(), one.Sub("robot/0/").ContentHash());
  EXPECT_EQ(three.Sub("truth/landmarks/").ContentHash(), one.Sub("truth/landmarks/").ContentHash());
  EXPECT_EQ(three.Sub("noise/").ContentHash(), one.Sub("noise/").ContentHash());
  std::set<double> starts;
  for (int r = 0; r < 3; ++r) {
    const std::string robot = "robot/" + std::to_string(r);
    EXPECT_GE(FinalOdometricErrorM(three, r), 22 - 1e-3);
    EXPECT_LE(FinalOdometricErrorM(three, r), 28 + 1e-3);
    starts.insert(three.Get<double>("truth/" + robot + "/poses/x_m")[0]);
    EXPECT_GT(Sum(three.Get<double>(robot + "/odometry/forward_m")), 900);
    EXPECT_EQ(three.at(robot + "/odometry/time_s").size() + 1,
              three.at("truth/" + robot + "/poses/time_s").size());
  }
  EXPECT_EQ(starts.size(), 3U);
}

TEST(SimulateLoop, TellsNoIdentitiesOutsideTheTruth) {
  const Blob log = SimulateLoop(Options("paper", 3)).Without("truth/");
  EXPECT_EQ(log.Texts("landmarks"), std::vector<std::string>{});
  for (const std::int32_t l : log.Get<std::int32_t>("robot/0/observations/landmark")) EXPECT_EQ(l, -1);
  for (const double r : log.Get<double>("robot/0/observations/range_m")) EXPECT_TRUE(std::isnan(r));
  for (const double b : log.Get<double>("robot/0/observations/bearing_rad")) EXPECT_TRUE(std::isnan(b));
}

TEST(SimulateLoop, TimesNeverRunBackwardsAndHeadingsAreInRange) {
  const Blob log = SimulateLoop(Options("hard", 4));
  const auto time = log.Get<double>("robot/0/odometry/time_s");
  EXPECT_TRUE(std::is_sorted(time.begin(), time.end()));
  EXPECT_GT(time.front(), 0);
  for (const double h : log.Get<double>("truth/robot/0/poses/heading_rad")) {
    EXPECT_GT(h, -std::numbers::pi);
    EXPECT_LE(h, std::numbers::pi);
  }
}

// Published results name seeds: a change of these hashes makes them another experiment. Made by this test
// itself; the names of arrays are part of them.
TEST(SimulateLoop, OneSeedGivesOneLogForEver) {
  const std::map<std::string, std::string> hashes{{"paper", "d227aca60f435a082a04c81ddb545e99"},
                                                  {"base", "38f31f4e39af9ab01864a7fd595a2f45"},
                                                  {"hard", "d6ca793295e1a9df3ed37daba12c2d1c"},
                                                  {"extreme", "394a54dbda67ff7756cd50cd153ec38b"},
                                                  {"museum", "fe5c5a26a3e175b117a79dd99cf9bf36"}};
  for (const auto& [difficulty, hash] : hashes)
    EXPECT_EQ(SimulateLoop(Options(difficulty, 101, 2)).ContentHash().Hex(), hash) << difficulty;
  EXPECT_NE(SimulateLoop(Options("base", 102, 2)).ContentHash(),
            SimulateLoop(Options("base", 101, 2)).ContentHash());
}

// [TFB98] figure 7: 70 m and 180 degrees.
TEST(SimulateLoop, TheMuseumsHeadingEndsBackwards) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Blob log = SimulateLoop(Options("museum", seed));
    const auto heading = log.Get<double>("truth/robot/0/poses/heading_rad");
    const double turned = heading.front() + Sum(log.Get<double>("robot/0/odometry/turn_rad"));
    EXPECT_GE(std::abs(WrapAngle(turned - heading.back())), 164.9 * kDeg) << seed;
    EXPECT_NEAR(static_cast<double>(log.at("robot/0/odometry/time_s").size()), 2700, 150) << seed;
  }
}

TEST(SimulateLoop, RefusesWhatItDoesNotKnow) {
  EXPECT_THROW(SimulateLoop(Options("easy", 1)), InputError);
  EXPECT_THROW(SimulateLoop(Options("base", 1, 0)), InputError);
  EXPECT_THROW(SimulateLoop(Options("base", 1, 65)), InputError);
}

}  // namespace
}  // namespace cairn::datasets
