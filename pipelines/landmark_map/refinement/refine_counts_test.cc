// What a least squares of landmarks makes of the counts, and so of the result.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "pipelines/landmark_map/landmark_map.h"
#include "pipelines/landmark_map/refinement/refine.h"
#include "pipelines/landmark_map/testing.h"

namespace cairn::landmark_map {
namespace {

constexpr std::array<std::array<double, 2>, 4> kSquare{{{20, 0}, {20, 20}, {0, 20}, {0, 0}}};

Settings CoarseSettings() {
  Settings settings;
  settings.map.grid = {1.0, 72};
  settings.map.core_m = 2.5;
  return settings;
}

TEST(Recentred, KeepsTheMassAndMovesIt) {
  const Settings settings = CoarseSettings();
  const MapRules& rules = settings.map;
  const Landmark before{20.0, 0.0, {1, 0, 0, 1}, 0, 3.0};
  Landmark now = before;
  now.x_m += 0.7;
  LayeredGrid counts = NoCounts(rules);
  counts.layers[0] = Layer(Box{19, -1, 3, 3});
  counts.layers[0].Row(0)[20] = before.count;
  const LayeredGrid moved = Recentred(counts, {before}, {now}, settings, 0.3);
  EXPECT_NEAR(moved.Sum(), before.count, 1e-12);
  const std::vector<Landmark> found = ExtractLandmarks(moved, rules);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].x_m, now.x_m, 0.05);
}

// Two identities and three classes: what is expected of landmarks alone is what they are found from again.
TEST(CountsFromLandmarks, HoldsEachLandmarkInItsPlaceAndItsLayer) {
  Settings settings = CoarseSettings();
  MapRules& rules = settings.map;
  rules.types = 2;
  rules.classes = {3, {0.9, 0.05, 0.05, 0.05, 0.9, 0.05, 0.05, 0.05, 0.9}};
  const std::vector<Landmark> landmarks{{1.3, -2.2, {0.3, 0, 0, 0.3}, 0, 4.0},
                                        {9.0, 5.4, {0.3, 0, 0, 0.3}, 1, 3.0},
                                        {-8.1, 3.0, {0.3, 0, 0, 0.3}, 2, 7.0, 0},
                                        {20.0, 20.3, {0.3, 0, 0, 0.3}, 2, 6.0, 1},
                                        {40.0, -9.0, {0.3, 0, 0, 0.3}, 2, 5.0, 2}};
  const LayeredGrid counts = CountsFromLandmarks(landmarks, settings);
  ASSERT_EQ(counts.layers.size(), 5U);
  for (std::size_t l = 0; l < 5; ++l) EXPECT_NEAR(counts.layers[l].Sum(), landmarks[l].count, 1e-9) << l;
  const std::vector<Landmark> found = ExtractLandmarks(counts, rules);
  ASSERT_EQ(found.size(), 5U);
  for (std::size_t l = 0; l < 5; ++l) {
    EXPECT_NEAR(found[l].x_m, landmarks[l].x_m, 0.1) << l;
    EXPECT_NEAR(found[l].y_m, landmarks[l].y_m, 0.1) << l;
    EXPECT_EQ(found[l].type, landmarks[l].type) << l;
    EXPECT_EQ(found[l].landmark_class, landmarks[l].landmark_class) << l;
    EXPECT_NEAR(found[l].count, landmarks[l].count, 0.1) << l;
  }
}

// As wide, or as far away, as only a worker gone bad says.
TEST(CountsFromLandmarks, ALandmarkThatNoMemoryHoldsIsRefused) {
  const Settings settings = CoarseSettings();
  for (const Landmark& bad :
       {Landmark{0.0, 0.0, {1e9, 0, 0, 1e9}, 0, 4.0}, Landmark{1e12, 0.0, {1, 0, 0, 1}, 0, 4.0},
        Landmark{0.0, 0.0, {1e20, 0, 0, 1e20}, 0, 4.0}})
    EXPECT_THROW(CountsFromLandmarks({bad}, settings), InputError) << bad.x_m << ' ' << bad.covariance_m2[0];
  const Landmark here{0.0, 0.0, {1, 0, 0, 1}, 0, 4.0}, there{5e7, 5e7, {1, 0, 0, 1}, 0, 4.0};
  EXPECT_NO_THROW(CountsFromLandmarks({there}, settings));
  EXPECT_THROW(CountsFromLandmarks({here, there}, settings), InputError);
}

// Corners on a grid of 3 m, whose cells are much larger than what the contact detections tell.
TEST(RefineMap, TheResultsLandmarksAreNearerToTheTruthThanCells) {
  const Blob log = SquareLog{.laps = 3, .side_m = 20.0}.Make();
  const auto farthest = [&](bool refine) {
    const BlobPtr result = RunInProcess(LandmarkMap({.cell_m = 3.0, .refine = refine, .starts = 1}),
                                        {{"log", std::make_shared<const Blob>(log)}});
    EXPECT_EQ(result->Scalar<std::uint8_t>("refinement/done"), refine ? 1 : 0);
    EXPECT_EQ(result->Text("refinement/reason"), refine ? "" : "not tried: refine=false");
    const auto x = result->Get<double>("map/landmark_x_m"), y = result->Get<double>("map/landmark_y_m");
    double worst = 0;
    for (const auto& corner : kSquare) {
      double nearest = 100;
      for (std::size_t k = 0; k < x.size(); ++k)
        nearest = std::min(nearest, std::hypot(x[k] - corner[0], y[k] - corner[1]));
      worst = std::max(worst, nearest);
    }
    return worst;
  };
  EXPECT_LT(farthest(true), 0.7 * farthest(false));
}

}  // namespace
}  // namespace cairn::landmark_map
