#include "pipelines/landmark_map/state/speculation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <numeric>

#include "pipelines/landmark_map/landmark_map.h"
#include "pipelines/landmark_map/testing.h"
#include "pipelines/testing/in_process.h"

namespace cairn::landmark_map {
namespace {

LayeredGrid Table(std::vector<double> values) {
  LayeredGrid grid;
  grid.layers.resize(3);
  grid.layers[1] = Layer(Box{-1, 2, static_cast<int>(values.size()), 1});
  grid.layers[1].values = std::move(values);
  return grid;
}

TEST(Agree, TakesWhatDiffersByRoundingOnly) {
  EXPECT_TRUE(Agree(Table({0.5, 0.0, 0.5}), Table({0.5, 0.0, 0.5})));
  EXPECT_TRUE(Agree(Table({0.5 * (1 + 1e-8), 0.0, 0.5}), Table({0.5, 0.0, 0.5})));
}

TEST(Agree, RefusesAPlaceThatIsMissingHoweverUnlikely) {
  EXPECT_FALSE(Agree(Table({1.0, 0.0, 1.0}), Table({1.0, 1e-12, 1.0})));
  EXPECT_FALSE(Agree(Table({1.0, 1e-12, 1.0}), Table({1.0, 0.0, 1.0})));
}

// What is small in the sum may be large as a ratio, and win after a few observations.
TEST(Agree, RefusesAnotherRatioHoweverUnlikely) {
  EXPECT_FALSE(Agree(Table({1.0, 2e-12, 1.0}), Table({1.0, 1e-12, 1.0})));
  EXPECT_FALSE(Agree(Table({1.0 + 1e-6, 0.0, 1.0}), Table({1.0, 0.0, 1.0})));
}

TEST(Agree, RefusesAnotherPlaceAndAnotherHeading) {
  LayeredGrid moved = Table({1.0});
  moved.layers[1].box = Box{0, 2, 1, 1};
  EXPECT_FALSE(Agree(moved, Table({1.0})));
  LayeredGrid turned = Table({1.0});
  std::swap(turned.layers[1], turned.layers[2]);
  EXPECT_FALSE(Agree(turned, Table({1.0})));
  turned.layers.pop_back();
  EXPECT_FALSE(Agree(turned, Table({1.0})));
}

Guesses Slices(std::vector<std::int32_t> first) {
  Guesses guesses;
  Blob table;
  Table({1.0}).StoreSparse("", &table);
  guesses.warm.assign(first.size(), table);
  guesses.warm[0] = {};
  guesses.first = std::move(first);
  return guesses;
}

TEST(Guesses, ComeBackAsTheyWereStored) {
  Guesses guesses = Slices({0, 70, 140});
  guesses.warm[1] = {};
  const Guesses back = Guesses::FromBlob(guesses.ToBlob());
  EXPECT_EQ(back.first, guesses.first);
  ASSERT_EQ(back.warm.size(), 3u);
  EXPECT_TRUE(back.warm[0].fields().empty());
  EXPECT_TRUE(back.warm[1].fields().empty());
  EXPECT_EQ(back.warm[2].ContentHash(), guesses.warm[2].ContentHash());
}

TEST(WorthGuessing, LongSlicesOfASharpMapAre) {
  const Schedule sharp{.settled = 2}, blurred{.settled = 1};
  const std::vector<bool> all{true, true, true}, none{false, false, false};
  EXPECT_EQ(WorthGuessing(Slices({0, 70, 140}), 210, 32, sharp), all);
  EXPECT_EQ(WorthGuessing(Slices({0, 70, 140}), 210, 32, blurred), none);
  EXPECT_EQ(WorthGuessing(Slices({0, 70, 140}), 210, 64, sharp), none);
  EXPECT_EQ(WorthGuessing(Slices({0, 3, 70}), 140, 32, sharp), (std::vector<bool>{false, true, true}));
  Guesses unknown = Slices({0, 70, 140});
  unknown.warm[2] = {};
  EXPECT_EQ(WorthGuessing(unknown, 210, 32, sharp), (std::vector<bool>{true, true, false}));
}

TEST(WorthGuessing, TheFirstSliceAloneIsNot) {
  const Schedule sharp{.settled = 2};
  EXPECT_EQ(WorthGuessing(Slices({0}), 210, 32, sharp), std::vector<bool>{false});
  EXPECT_EQ(WorthGuessing(Slices({0, 200}), 210, 32, sharp), (std::vector<bool>{false, false}));
  EXPECT_TRUE(WorthGuessing(Guesses(), 210, 32, sharp).empty());
}

TEST(TooShort, WhereMoreThanAQuarterWasGuessedWrong) {
  EXPECT_FALSE(TooShort(0, 0));
  EXPECT_FALSE(TooShort(4, 3));
  EXPECT_TRUE(TooShort(4, 2));
}

BlobPtr MapOfLog(const Blob& log, const Options& options) {
  return RunInProcess(LandmarkMap(options), {{"log", std::make_shared<const Blob>(log)}});
}

std::int64_t Total(const Blob& result, const char* column) {
  const auto values = result.Get<std::int64_t>(column);
  return std::accumulate(values.begin(), values.end(), std::int64_t{0});
}

// Both modes, slices in order and slices side by side, against one pass over all steps; returns the result of
// the latter mode.
BlobPtr ExpectWhatOnePassGives(const Blob& log, const Options& whole, double slice_mcells) {
  Options in_order = whole;
  in_order.slice_mcells = slice_mcells;
  in_order.speculate = false;
  Options side_by_side = in_order;
  side_by_side.speculate = true;
  const BlobPtr expected = MapOfLog(log, whole);
  const BlobPtr ordered = MapOfLog(log, in_order), guessed = MapOfLog(log, side_by_side);
  EXPECT_EQ(Total(*ordered, "history/guessed"), 0);
  for (const BlobPtr& sliced : {ordered, guessed}) {
    for (const char* name : {"robot/0/poses/x_m", "robot/0/poses/y_m", "robot/0/poses/heading_rad",
                             "robot/0/poses/covariance", "robot/0/observations/probability",
                             "map/grid/probability", "map/landmark_x_m", "map/landmark_y_m"}) {
      const auto a = expected->Get<double>(name), b = sliced->Get<double>(name);
      if (a.size() != b.size()) ADD_FAILURE() << name << ": " << a.size() << " and " << b.size();
      for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
        EXPECT_NEAR(a[i], b[i], 1e-6) << name << ' ' << i;
    }
  }
  return guessed;
}

TEST(Speculation, GivesWhatOneSequentialPassGives) {
  const Blob log = SquareLog{.laps = 60, .side_m = 20.0, .drift_rad_per_m = 0.002}.Make();
  const BlobPtr result =
      ExpectWhatOnePassGives(log, {.cell_m = 1.0, .tolerance = 0.0, .starts = 1, .slice_mcells = 1000}, 0.4);
  EXPECT_GT(Total(*result, "history/confirmed"), 10);
}

// A contact detection every 50 m: beliefs remember where they began for longer than guesses overlap.
TEST(Speculation, WhatWasGuessedWrongIsComputedAgain) {
  const Blob log = SquareLog{.laps = 18, .side_m = 50.0, .drift_rad_per_m = 0.002}.Make();
  const BlobPtr result =
      ExpectWhatOnePassGives(log, {.cell_m = 1.0, .iterations = 4, .starts = 1, .slice_mcells = 1000}, 0.6);
  EXPECT_GT(Total(*result, "history/guessed"), Total(*result, "history/confirmed"));
}

}  // namespace
}  // namespace cairn::landmark_map
