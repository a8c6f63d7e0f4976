#include "pipelines/local_map/path/pass_watch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "pipelines/local_map/testing/corridor.h"
#include "schema/error.h"

namespace cairn::local_map {
namespace {

struct Ticks : Progress {
  void Tick() override {}
};

// What somebody puts into the corridor before the second pass, and how many of the beams are lost.
struct Changed {
  bool box = false;    // of 1.4 m
  bool black = false;  // it was there before, and swallowed the light
  double lost = 0;
};

// Twice along the corridor, 5 m each; the path has the second pass `off`.
std::vector<Passing> TwoPasses(const Point& off, const Changed& changed = {}) {
  constexpr int kScans = 50;
  Rng rng(5);
  PassWatch watch({LaserBeams(), 0, 10});
  const std::vector<TestWall> walls = NichedCorridor();
  std::vector<TestWall> with_box = walls;
  for (const TestWall& wall : TestBox(0.8, 1.4, {1.9, 0.4, 0})) with_box.push_back(wall);
  for (int k = 0; k < 2 * kScans; ++k) {
    const bool first = k < kScans;
    const Pose robot{-4 + 0.1 * (k % kScans), -0.2, 0};
    std::vector<double> ranges = LaserScan(changed.box && !first ? with_box : walls, robot, rng);
    if (changed.black && first) {
      const std::vector<double> before_box = LaserScan(with_box, robot, rng);
      for (std::size_t b = 0; b < ranges.size(); ++b)
        if (std::abs(before_box[b] - ranges[b]) > 0.1) ranges[b] = std::nan("");
    }
    for (double& range : ranges)
      if (changed.lost > 0 && rng.Uniform() < changed.lost) range = std::nan("");
    const Pose on_path = first ? robot : Pose{robot.x_m + off.x_m, robot.y_m + off.y_m, 0};
    watch.Add(k, on_path, 0.1 * k + (first ? 0 : 10), {.time_s = 0, .turret_rad = 0, .range_m = ranges});
  }
  Ticks ticks;
  return watch.Compare(ticks);
}

double MostThrough(const std::vector<Passing>& passes) {
  double most = 0;
  for (const Passing& passing : passes) most = std::max(most, passing.through);
  return most;
}

double ShareDoubled(const std::vector<Passing>& passes) {
  const auto doubled = std::ranges::count_if(passes, &Passing::doubled);
  return static_cast<double>(doubled) / static_cast<double>(passes.size());
}

TEST(PassWatch, TwoPassesThatThePathHasWhereTheyWereMeet) {
  const std::vector<Passing> passes = TwoPasses({});
  EXPECT_GE(passes.size(), 18U);
  EXPECT_EQ(ShareDoubled(passes), 0);
  for (const Passing& passing : passes) EXPECT_LT(passing.through, 0.05);
}

TEST(PassWatch, ACorridorThatIsDrawnTwiceIsSeenAndByHowMuch) {
  for (const Point& off : {Point{0, 1.5}, Point{0, -1.2}, Point{0.9, 1.2}}) {
    const std::vector<Passing> passes = TwoPasses(off);
    ASSERT_GE(passes.size(), 10U);
    EXPECT_GT(ShareDoubled(passes), 0.7);
    for (const Passing& passing : passes) {
      if (!passing.doubled) continue;
      const double back = passing.from < passing.to ? -1 : 1;
      EXPECT_NEAR(passing.off.y_m, back * off.y_m, 0.35);
    }
  }
}

// As a cheap laser does. The scans bear witness all the same.
TEST(PassWatch, BeamsMayBeLostHereAndThere) {
  for (const double lost : {0.2, 0.4}) {
    const Changed changed{.lost = lost};
    const std::vector<Passing> meet = TwoPasses({}, changed), apart = TwoPasses({0, 1.5}, changed);
    EXPECT_GE(meet.size(), 18U) << lost;
    EXPECT_EQ(ShareDoubled(meet), 0) << lost;
    ASSERT_GE(apart.size(), 10U) << lost;
    EXPECT_GT(ShareDoubled(apart), 0.7) << lost;
  }
}

// Nobody looked through what gave no answer.
TEST(PassWatch, ABlockOfBeamsWithoutAnAnswerSawNothing) {
  const std::vector<Passing> white = TwoPasses({}, {.box = true}),
                             black = TwoPasses({}, {.box = true, .black = true});
  const auto from_first = [](const Passing& passing) { return passing.from < passing.to; };
  EXPECT_GT(MostThrough(white), 0.25);
  std::vector<Passing> of_first;
  std::ranges::copy_if(black, std::back_inserter(of_first), from_first);
  EXPECT_GE(of_first.size(), 9U);
  EXPECT_LT(MostThrough(of_first), 0.05);
}

// No other place would be better: nothing is drawn twice.
TEST(PassWatch, WhatWasMovedMeanwhileIsNotDrawnTwice) {
  const std::vector<Passing> passes = TwoPasses({}, {.box = true});
  EXPECT_GT(MostThrough(passes), 0.25);
  EXPECT_EQ(ShareDoubled(passes), 0);
}

TEST(PassWatch, ALoopConstraintPutsTheSecondPassWhereItMeetsTheFirst) {
  const std::vector<PathNode> nodes{{.robot = 0, .scan = 0, .path_m = 0, .dead = {}, .at = {9, 9}},
                                    {.robot = 1, .scan = 0, .path_m = 0, .dead = {}, .at = {1, 0}},
                                    {.robot = 1, .scan = 10, .path_m = 5, .dead = {}, .at = {4, 2}}};
  const std::vector<LoopConstraint> made =
      MakePassConstraints({{.from = 3, .to = 12, .through = 0.5, .doubled = true, .off = {-0.5, 1}},
                           {.from = 3, .to = 12, .through = 0, .doubled = false, .off = {}}},
                          1, nodes);
  ASSERT_EQ(made.size(), 1U);
  EXPECT_EQ(made[0].from, 1);
  EXPECT_EQ(made[0].to, 2);
  EXPECT_EQ(made[0].offset.x_m, 2.5);
  EXPECT_EQ(made[0].offset.y_m, 3);
  EXPECT_THROW(
      MakePassConstraints({{.from = 3, .to = 12, .through = 1, .doubled = true, .off = {}}}, 2, nodes),
      InputError);
}

}  // namespace
}  // namespace cairn::local_map
