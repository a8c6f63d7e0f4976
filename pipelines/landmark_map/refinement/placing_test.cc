#include "pipelines/landmark_map/refinement/placing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pipelines/landmark_map/refinement/testing.h"

namespace cairn::landmark_map {
namespace {

constexpr double kSigma_m = 0.15;

TEST(Placing, WhatAllHaveInCommonIsFarAheadOfAnyOtherPlace) {
  const Submap one = SubmapOf({DriveThroughRoom(1)}), base = SubmapOf({DriveThroughRoom(1, 0, 4)});
  ASSERT_EQ(one.landmarks.size(), kSeenInRoom1);
  const Placings placings = FindPlacings(one, base, kSigma_m);
  EXPECT_EQ(placings.here.pairs.size(), kSeenInRoom1);
  EXPECT_EQ(placings.here.contradicted, 0U);
  EXPECT_GT(placings.LeadNats(), 30);
}

// As if the second robot's room, which is another one, lay on the first one's.
TEST(Placing, RoomsOnTopOfEachOtherSpeakAgainstIt) {
  const Submap one = SubmapOf({DriveThroughRoom(1)}), base = SubmapOf({DriveThroughRoom(2)});
  const Placings placings = FindPlacings(one, base, kSigma_m);
  EXPECT_GE(placings.here.contradicted, 10U);
  EXPECT_LT(placings.here.nats, -10);
  EXPECT_LT(placings.LeadNats(), 0) << "nothing in common is likelier";
}

TEST(Placing, FindsWhereASubmapThatWasMovedBelongs) {
  const Pose away{3, -2, 0.7};
  const Submap one = SubmapOf({DriveThroughRoom(1, 0, 0, away)}), base = SubmapOf({DriveThroughRoom(1)});
  const Placings placings = FindPlacings(one, base, kSigma_m);
  ASSERT_TRUE(placings.other.has_value());
  EXPECT_EQ(placings.other->pairs.size(), kSeenInRoom1);
  const Pose back = Compose(placings.other->at, away);
  EXPECT_NEAR(back.x_m, 0, 0.1);
  EXPECT_NEAR(back.y_m, 0, 0.1);
  EXPECT_NEAR(WrapAngle(back.heading_rad), 0, 0.03);
  EXPECT_LT(placings.LeadNats(), -30);
}

// A few landmarks that fit by chance say less than their place takes to be told.
TEST(Placing, ASingleLandmarkInCommonSaysNothing) {
  Submap one = SubmapOf({DriveThroughRoom(1)}), base = one;
  one.landmarks.resize(1);
  base.landmarks.resize(1);
  one.looks.clear();
  base.looks.clear();
  EXPECT_LE(FindPlacings(one, base, kSigma_m).LeadNats(), 1e-9);
  EXPECT_EQ(FindPlacings(Submap{}, base, kSigma_m).LeadNats(), 0);
}

// Posts at random, of which the one sees those of the other's that `shared` says, and as many of its own. No
// look speaks against anything: only how many lie on one another tells.
TEST(Placing, FewLandmarksInCommonMayBeChance) {
  const auto odds_nats = [](std::size_t shared, std::size_t each) {
    Rng rng(shared);
    Submap one, base;
    for (Submap* submap : {&one, &base}) submap->views.push_back({3, 0, -1.5, 1.5});
    for (std::size_t k = 0; k < 2 * each - shared; ++k) {
      const Submap::Seen seen{rng.Uniform(0, 10), rng.Uniform(0, 10), static_cast<std::int32_t>(k), 3, true};
      if (k < each) base.landmarks.push_back(seen);
      if (k + shared >= each) one.landmarks.push_back(seen);
    }
    const Placing here = PlacingHere(one, base, 0.1);
    EXPECT_GE(here.pairs.size(), shared);
    return here.odds_nats;
  };
  EXPECT_LT(odds_nats(3, 15), 0);
  EXPECT_LT(odds_nats(4, 25), std::log(99.0)) << "where many stand";
  EXPECT_GT(odds_nats(6, 15), 5);
  EXPECT_GT(odds_nats(10, 15), 20);
}

// The words of the verdict count on it: of submaps that have nothing in common no more than one of ten finds
// a place whose odds are ten to one.
TEST(Placing, ByChanceNoMorePlacesAreAsLikelyAsTheOddsSay) {
  constexpr int kPairs = 60;
  int likely = 0;
  Rng rng(5);
  for (int pair = 0; pair < kPairs; ++pair) {
    Submap one, base;
    for (Submap* submap : {&one, &base}) {
      submap->views.push_back({3, 0, -1.5, 1.5});
      for (std::int32_t k = 0; k < 12; ++k)
        submap->landmarks.push_back({rng.Uniform(0, 9), rng.Uniform(0, 9), k, 3, true});
    }
    const Placings placings = FindPlacings(one, base, 0.1);
    likely += placings.other && placings.other->odds_nats > std::log(10.0);
  }
  EXPECT_LE(likely, kPairs / 10);
}

TEST(SubmapOf, HasWhatItSawTwiceAndHowFarItSees) {
  const std::vector<PlacedRow> rows = {{0, {0, 0, 0}, 2, 0.1, 0},
                                       {0, {0, 0, 0}, 1, 3.1, 1},
                                       {1, {1, 0, 0}, 1, 0.1, 0},
                                       {1, {1, 0, 0}, 1, -3.1, -1}};
  const Submap submap = SubmapOf({rows});
  ASSERT_EQ(submap.landmarks.size(), 1U);
  EXPECT_NEAR(submap.landmarks[0].x_m, (2 * std::cos(0.1) + 1 + std::cos(0.1)) / 2, 1e-12);
  EXPECT_EQ(submap.landmarks[0].count, 2);
  EXPECT_EQ(submap.looks.size(), 2U);
}

// Behind it, where bearings jump from pi to -pi.
TEST(SubmapOf, LooksWhereItsSensorFaces) {
  std::vector<PlacedRow> rows;
  for (int i = 0; i < 100; ++i)
    rows.push_back({1.0 * i, {0, 0, 0}, 3, WrapAngle(std::numbers::pi + 0.01 * (i - 50)), 0});
  const Submap submap = SubmapOf({rows});
  ASSERT_EQ(submap.views.size(), 1U);
  EXPECT_NEAR(std::abs(submap.views[0].middle_rad), std::numbers::pi, 0.02);
  EXPECT_NEAR(submap.views[0].left_rad, 0.48, 0.03);
  EXPECT_NEAR(submap.views[0].right_rad, -0.48, 0.03);
}

}  // namespace
}  // namespace cairn::landmark_map
