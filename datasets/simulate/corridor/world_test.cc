// The parts of the simulated corridor, each on a case that can be worked by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "datasets/simulate/corridor/camera.h"
#include "datasets/simulate/corridor/change.h"
#include "datasets/simulate/corridor/detectors.h"
#include "datasets/simulate/corridor/sonar.h"

namespace cairn::datasets::corridor {
namespace {

// 40 m of bare corridor, but for a closed door in the outer wall from 9.5 to 10.5 m, a hallway in the inner
// one from 19 to 21 m, a lamp at 30 m.
World BareWorld() {
  World world;
  world.length_m = 40;
  world.walls[kOuter].openings.push_back(
      {OpeningKind::kDoor, 9.5, 10.5, kDoorHeightM, {0.30, 0.36, 0.47}, {0.6, 0.6, 0.6}, 0, false});
  world.walls[kInner].openings.push_back(
      {OpeningKind::kHallway, 19, 21, kHeightM, {0.60, 0.52, 0.42}, {}, 0, false});
  world.lamps.push_back({30, {1, 1, 1}});
  return world;
}

Run QuietRun() {
  Run run;
  run.open = {std::vector<bool>{false}, std::vector<bool>{false}};
  run.lamp_on = {true};
  return run;
}

Hit HitFrom(const Scene& scene, double x_m, Vec3 direction, double time_s = 0) {
  return scene.Cast({x_m, 0, 1}, direction, scene.PillarsNear(x_m, time_s));
}

TEST(CorridorScene, RaysByHand) {
  const World world = BareWorld();
  auto run = QuietRun();
  run.people.push_back(
      {.x_m = 0, .speed_mps = 0.5, .y_m = 0.7, .height_m = 1.7, .shirt = {}, .trousers = {}, .skin = {}});
  const Scene scene(world, run);
  const Hit wall = HitFrom(scene, 15, {0, 1, 0});
  EXPECT_EQ(wall.surface, Surface::kWall);
  EXPECT_DOUBLE_EQ(wall.distance, kHalfWidthM);
  const Hit door = HitFrom(scene, 10, {0, 1, 0});  // ten centimetres within the wall
  EXPECT_EQ(door.surface, Surface::kDoor);
  EXPECT_NEAR(door.distance, kHalfWidthM + 0.1, 1e-12);
  const Hit hallway = HitFrom(scene, 20, {0, -1, 0});
  EXPECT_EQ(hallway.surface, Surface::kWithin);
  EXPECT_NEAR(hallway.distance, kHalfWidthM + 7, 1e-12);
  EXPECT_EQ(HitFrom(scene, 15, {0, 0.1, 1}).surface, Surface::kCeiling);
  EXPECT_NEAR(HitFrom(scene, 15, {0, 0.1, -1}).distance, 1, 1e-12);
  EXPECT_NEAR(HitFrom(scene, 15, {1, 0, 0}).distance, 25 + kCornerM, 1e-12);
  // She passes at 15 m after half a minute, 20 cm thick to either side of her middle.
  const Hit person = HitFrom(scene, 15, {0, 1, 0}, 30);
  EXPECT_EQ(person.surface, Surface::kPerson);
  EXPECT_NEAR(person.distance, 0.5, 1e-12);
  // The ray that is 1.75 m high there goes over her head.
  EXPECT_EQ(HitFrom(scene, 15, {0, 1, 1.5}, 30).surface, Surface::kCeiling);
}

TEST(CorridorScene, AnOpenDoorShowsARoom) {
  const World world = BareWorld();
  auto run = QuietRun();
  run.open[kOuter][0] = true;
  const Hit hit = HitFrom(Scene(world, run), 10, {0, 1, 0});
  EXPECT_EQ(hit.surface, Surface::kWithin);
  EXPECT_NEAR(hit.distance, kHalfWidthM + 2.6, 1e-12);
}

View ViewAt(const Scene& scene, double x_m, Look look) {
  Rng rng(1);
  return TakeImage(scene, Shade(scene), {0, {x_m, 0, 0}}, look, rng);
}

TEST(CorridorCamera, SeesWhatItPointsAt) {
  const World world = BareWorld();
  const auto run = QuietRun();
  const Scene scene(world, run);
  // 1 m of door at 1.5 m, of 64 columns that see 2 * 1.5 tan 36 = 2.18 m; from below to its top and a little
  // over.
  EXPECT_NEAR(ViewAt(scene, 10, Look::kOuter).door_share, 1 / 2.18, 0.06);
  EXPECT_EQ(ViewAt(scene, 15, Look::kOuter).door_share, 0);
  EXPECT_EQ(ViewAt(scene, 10, Look::kInner).door_share, 0);
  EXPECT_EQ(ViewAt(scene, 20, Look::kInner).door_share, 0) << "a hallway is no door";
  // 1.2 by 0.6 m of lamp, 1.5 m above: of 2.18 by 2.04 m.
  EXPECT_NEAR(ViewAt(scene, 30, Look::kCeiling).light_share, 1.2 * 0.6 / (2.18 * 2.04), 0.01);
  EXPECT_EQ(ViewAt(scene, 20, Look::kCeiling).light_share, 0);
  auto dark = QuietRun();
  dark.lamp_on = {false};
  EXPECT_EQ(ViewAt(Scene(world, dark), 30, Look::kCeiling).light_share, 0);
}

// What comes into view first as the robot drives on is at the side of its heading.
TEST(CorridorCamera, LeftAndRightAreAsTheyShouldBe) {
  const World world = BareWorld();
  const auto run = QuietRun();
  const Scene scene(world, run);
  const auto bluer_half = [](const RgbImage& image) {
    std::int64_t left = 0, right = 0;
    for (int row = 20; row < 40; ++row) {
      for (int column = 0; column < image.columns; ++column) {
        const auto at = static_cast<std::size_t>(3 * (row * image.columns + column));
        (column < image.columns / 2 ? left : right) += image.rgb[at + 2] - image.rgb[at];
      }
    }
    return left > right ? "left" : "right";
  };
  EXPECT_STREQ(bluer_half(ViewAt(scene, 9.2, Look::kOuter).image), "right");
  EXPECT_STREQ(bluer_half(ViewAt(scene, 10.8, Look::kOuter).image), "left");
}

TEST(CorridorSonar, ReadsTheWallsAround) {
  const World world = BareWorld();
  const auto run = QuietRun();
  const Scene scene(world, run);
  std::vector<float> left, right;
  Rng rng(4);
  for (int k = 0; k < 51; ++k) {
    const std::vector<float> ranges = SonarRanges(scene, {0, {15, 0.2, 0}}, rng);
    ASSERT_EQ(ranges.size(), 24U);
    left.push_back(ranges[6]);
    right.push_back(ranges[18]);
  }
  std::ranges::sort(left);
  std::ranges::sort(right);
  // From the ring's edge, 25 cm off the robot's middle.
  EXPECT_NEAR(left[25], kHalfWidthM - 0.2 - 0.25, 0.02);
  EXPECT_NEAR(right[25], kHalfWidthM + 0.2 - 0.25, 0.02);
}

TEST(CorridorWorldDrawn, IsAsThePaperDescribesIt) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Rng rng(seed);
    const World world = DrawWorld(89, rng);
    for (const Wall& wall : world.walls) {
      double orange_m = 0;
      for (const Stretch& stretch : wall.orange) orange_m += stretch.x1_m - stretch.x0_m;
      EXPECT_NEAR(orange_m, 89.0 / 4, 1e-9);
    }
    const auto doors = [&](Side side) {
      return std::ranges::count(world.walls[side].openings, OpeningKind::kDoor, &Opening::kind);
    };
    EXPECT_GE(doors(kOuter), 18);
    EXPECT_LE(doors(kInner), 4);
    EXPECT_GE(doors(kInner), 2);
    EXPECT_EQ(std::ranges::count(world.walls[kOuter].panels, PanelKind::kWindow, &Panel::kind), 2);
    int irregular = 0;
    for (std::size_t i = 1; i < world.lamps.size(); ++i)
      irregular += std::abs(world.lamps[i].x_m - world.lamps[i - 1].x_m - 5) > 0.6 ? 1 : 0;
    EXPECT_GE(irregular, 1) << "one or two are shifted, which two gaps show";
    EXPECT_LE(irregular, 4);
    EXPECT_TRUE(world.bins.size() == 3 || world.bins.size() == 4);
  }
}

TEST(CorridorChange, LeavesDoorsAndLampsWhereTheyAre) {
  Rng rng(2), change_rng(3);
  const World before = DrawWorld(89, rng);
  World after = before;
  ChangeWorld(1, &after, change_rng);
  EXPECT_LT(after.walls[kOuter].panels.size(), before.walls[kOuter].panels.size());
  for (std::size_t i = 0; i < before.walls[kOuter].openings.size(); ++i) {
    EXPECT_EQ(after.walls[kOuter].openings[i].x0_m, before.walls[kOuter].openings[i].x0_m);
    EXPECT_NE(after.walls[kOuter].openings[i].colour.r, before.walls[kOuter].openings[i].colour.r);
  }
  EXPECT_EQ(after.lamps.size(), before.lamps.size());
}

// Columns [from, to) in one colour, the others of the light brown wall.
RgbImage WallWith(int from, int to, std::array<std::uint8_t, 3> colour) {
  RgbImage image{kImageRows, kImageColumns, {}};
  const std::array<std::uint8_t, 3> wall{152, 130, 100};
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.columns; ++column) {
      const auto& shown = column >= from && column < to ? colour : wall;
      image.rgb.insert(image.rgb.end(), shown.begin(), shown.end());
    }
  }
  return image;
}

TEST(CorridorDetectors, TellDoorsByColourAndDepth) {
  const std::vector<float> wall(3, 1.15F), room{1.2F, 3.7F, 1.2F}, hallway{1.2F, 6, 6};
  EXPECT_FALSE(DetectDoor(WallWith(0, 0, {}), wall));
  EXPECT_TRUE(DetectDoor(WallWith(30, 45, {60, 72, 94}), wall)) << "paint";
  EXPECT_TRUE(DetectDoor(WallWith(30, 45, {72, 44, 26}), wall)) << "wood";
  EXPECT_FALSE(DetectDoor(WallWith(30, 45, {172, 94, 38}), wall)) << "the orange wall";
  EXPECT_FALSE(DetectDoor(WallWith(30, 45, {120, 120, 115}), wall)) << "grey, where nothing is open";
  EXPECT_TRUE(DetectDoor(WallWith(30, 45, {120, 120, 115}), room));
  EXPECT_FALSE(DetectDoor(WallWith(0, 0, {}), room)) << "deep, and yet it looks like a wall";
  EXPECT_FALSE(DetectDoor(WallWith(30, 45, {120, 120, 115}), hallway));
}

TEST(CorridorDetectors, TellLightsByGlare) {
  EXPECT_FALSE(DetectLight(WallWith(0, 0, {})));
  EXPECT_TRUE(DetectLight(WallWith(30, 31, {255, 255, 250})));
  EXPECT_FALSE(DetectLight(WallWith(30, 45, {255, 255, 200}))) << "yellow is no lamp's colour";
}

}  // namespace
}  // namespace cairn::datasets::corridor
