#include "pipelines/landmark_map/refinement/seen_briefly.h"

#include <gtest/gtest.h>

#include "pipelines/landmark_map/refinement/testing.h"

namespace cairn::landmark_map {
namespace {

constexpr double kRowsAgree_m = 0.15, kOthersApart_m = 0.3;
constexpr int kTypeOfBrief = 3;

std::vector<Landmark> Brief(const std::vector<PlacedRow>& rows, const std::vector<Landmark>& known = {}) {
  return FindSeenBriefly({rows}, known, kRowsAgree_m, kOthersApart_m, kTypeOfBrief);
}

// A drive through a room that is known, without names, and a stay in a doorway 20 m away: `shown` rows of
// something that stands at (22, 0), `looked` images of what is known there that do not show it.
std::vector<PlacedRow> WithAStay(int shown, int looked = 0) {
  std::vector<PlacedRow> rows = DriveThroughRoom(1);
  double time_s = 1000;
  for (int k = 0; k < shown; ++k)
    rows.push_back({time_s++, {20 + 0.2 * k, 0, 0}, 2.02 - 0.2 * k, 0.01 * (k % 2), -1});
  for (int k = 0; k < looked; ++k) rows.push_back({time_s++, {20 + 0.01 * k, 0, 0}, 3.0, 0.2, 0});
  for (PlacedRow& row : rows) row.told = false;
  return rows;
}

TEST(FindSeenBriefly, WhatThreeImagesShowIsALandmarkWhereHardlyAnythingIsFalse) {
  const std::vector<Landmark> found = Brief(WithAStay(3));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].x_m, 22, 0.1);
  EXPECT_NEAR(found[0].y_m, 0, 0.1);
  EXPECT_EQ(found[0].type, kTypeOfBrief);
  EXPECT_EQ(found[0].count, 3);
  EXPECT_TRUE(Brief(WithAStay(2)).empty());
}

TEST(FindSeenBriefly, WhatManyMoreImagesShouldShowIsNone) {
  EXPECT_EQ(Brief(WithAStay(3, 1)).size(), 1U);
  EXPECT_TRUE(Brief(WithAStay(3, 100)).empty());
}

TEST(FindSeenBriefly, WhatAnImageShowsTwiceIsNotOne) {
  std::vector<PlacedRow> rows = WithAStay(3);
  rows.back().time_s = rows[rows.size() - 2].time_s;
  EXPECT_TRUE(Brief(rows).empty());
}

TEST(FindSeenBriefly, BesideALandmarkThatIsKnownThereIsNone) {
  Landmark known{22.2, 0.1, {1, 0, 0, 1}, kTypeOfBrief, 5};
  EXPECT_TRUE(Brief(WithAStay(3), {known}).empty());
  known.x_m = 24;
  EXPECT_EQ(Brief(WithAStay(3), {known}).size(), 1U);
}

TEST(FindSeenBriefly, WhatHasANameIsNotLookedAt) {
  std::vector<PlacedRow> rows = WithAStay(3);
  for (PlacedRow& row : rows) row.told = true;
  EXPECT_TRUE(Brief(rows).empty());
}

// In every image one that is false, anywhere in view: some fall together in threes.
TEST(FindSeenBriefly, FalseObservationsThatFellTogetherAreNone) {
  for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6, 7, 8}) {
    Rng rng(seed);
    std::vector<PlacedRow> rows;
    for (const PlacedRow& row : DriveThroughRoom(1)) {
      if (rows.empty() || rows.back().time_s != row.time_s)
        rows.push_back({row.time_s, row.from, rng.Uniform(0.5, 5), rng.Uniform(-1, 1), -1, false});
      rows.push_back(row);
    }
    EXPECT_TRUE(Brief(rows).empty()) << seed;
  }
}

}  // namespace
}  // namespace cairn::landmark_map
