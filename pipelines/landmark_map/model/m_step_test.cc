#include "pipelines/landmark_map/model/m_step.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <utility>

namespace cairn::landmark_map {
namespace {

MapRules Rules(int types) {
  MapRules rules;
  rules.grid = {1.0, 4};
  rules.types = types;
  rules.observation_m = 0.0;
  rules.radius_m = 3.0;
  rules.core_m = 1.0;
  return rules;
}

LayeredGrid Points(int layers, int layer, const std::vector<std::array<double, 3>>& points) {
  LayeredGrid counts;
  counts.layers.resize(static_cast<std::size_t>(layers));
  counts.layers[layer] = Layer(Box{0, 0, 20, 20});
  for (const auto& [x, y, count] : points) {
    counts.layers[layer].Row(static_cast<int>(y))[static_cast<int>(x)] = count;
  }
  return counts;
}

// [TBF98] eq. 19 by hand: 4 contact detections here, 1 two cells away, 5 out of sight.
TEST(MapFromCounts, UnidentifiedLandmarksShareTheirPerceptualRadiusOnly) {
  const LayeredGrid map = MapFromCounts(Points(1, 0, {{5, 5, 4}, {7, 5, 1}, {15, 15, 5}}), Rules(0));
  EXPECT_DOUBLE_EQ(map.layers[0].At(5, 5), 4.0 / 5.0);
  EXPECT_DOUBLE_EQ(map.layers[0].At(7, 5), 1.0 / 5.0);
  EXPECT_DOUBLE_EQ(map.layers[0].At(15, 15), 1.0);
  EXPECT_EQ(map.layers[0].At(6, 5), 0.0);
}

// 4 contact detections of the cell, 1 within the radius, a prior of half a contact detection: 4 / 5.5. A cell
// far from all others with a hundredth of a contact detection holds hardly a landmark: 0.01 / 0.51.
TEST(MapFromCounts, ThePriorSpeaksAgainstLandmarksThatHardlyAnythingSpeaksFor) {
  MapRules rules = Rules(0);
  rules.prior_count = 0.5;
  const LayeredGrid map = MapFromCounts(Points(1, 0, {{5, 5, 4}, {7, 5, 1}, {15, 15, 0.01}}), rules);
  EXPECT_DOUBLE_EQ(map.layers[0].At(5, 5), 4.0 / 5.5);
  EXPECT_DOUBLE_EQ(map.layers[0].At(15, 15), 0.01 / 0.51);
}

// False observations have a chance of 1e-3 a cell; what is below a thousandth of it is no part of the map.
TEST(MapFromCounts, BoxesEndWhereTheMapSaysNothing) {
  MapRules rules = Rules(1);
  rules.prior_count = 0.03;
  for (const int layer : {0, 1}) {
    const LayeredGrid map = MapFromCounts(Points(2, layer, {{5, 5, 4}, {7, 6, 1}, {15, 15, 1e-8}}), rules);
    EXPECT_EQ(map.layers[layer].box, (Box{5, 5, 3, 2})) << layer;
  }
}

TEST(MapFromCounts, TheExactModelKeepsEveryCell) {
  MapRules rules = Rules(0);
  rules.exact = true;
  const LayeredGrid map = MapFromCounts(Points(1, 0, {{5, 5, 4}, {7, 5, 1e-9}}), rules);
  EXPECT_EQ(map.layers[0].At(7, 5), 1e-9 / (4.0 + 1e-9));
}

TEST(MapFromCounts, AnIdentifiedLandmarkStandsInOnePlace) {
  const LayeredGrid map = MapFromCounts(Points(3, 1, {{5, 5, 4}, {15, 15, 4}}), Rules(2));
  EXPECT_DOUBLE_EQ(map.layers[1].At(5, 5), 0.5);
  EXPECT_DOUBLE_EQ(map.layers[1].Sum(), 1.0);
  EXPECT_TRUE(map.layers[0].box.empty());
  EXPECT_TRUE(map.layers[2].box.empty());
}

// An identified landmark and others of two classes: where cells, radii and errors are all four times smaller,
// and false observations as frequent a cell, map and perception are the same, cell by cell.
TEST(MapFromCounts, LengthsCountInCellsAlone) {
  LayeredGrid counts = Points(3, 0, {{4, 4, 2}, {6, 9, 1}});
  counts.layers[1] = Points(1, 0, {{5, 5, 4}, {7, 5, 1}, {14, 15, 2}}).layers[0];
  counts.layers[2] = Points(1, 0, {{6, 5, 3}, {9, 8, 2}, {13, 15, 0.5}}).layers[0];
  const auto both = [&](double scale) {
    MapRules rules = Rules(1);
    rules.grid.cell_m *= scale;
    rules.classes = {2, {0.8, 0.2, 0.3, 0.7}};
    rules.observation_m = 0.9 * scale;
    rules.radius_m = 5.1 * scale;
    rules.core_m = 2.1 * scale;
    rules.false_rate_per_m2 = 0.002 / (scale * scale);
    const LayeredGrid map = MapFromCounts(counts, rules);
    return std::pair{map, MakePerception(map, rules).likelihood};
  };
  const auto [map, perception] = both(1.0);
  const auto [fine_map, fine_perception] = both(0.25);
  for (std::size_t l = 0; l < 3; ++l) {
    ASSERT_EQ(map.layers[l].box, fine_map.layers[l].box) << l;
    ASSERT_EQ(perception.layers[l].box, fine_perception.layers[l].box) << l;
    EXPECT_GT(map.layers[l].Max(), 0.1) << l;
    for (std::size_t i = 0; i < map.layers[l].values.size(); ++i)
      EXPECT_NEAR(map.layers[l].values[i], fine_map.layers[l].values[i], 1e-12);
    for (std::size_t i = 0; i < perception.layers[l].values.size(); ++i)
      EXPECT_NEAR(perception.layers[l].values[i], fine_perception.layers[l].values[i], 1e-12);
  }
}

TEST(MakePerception, NoLandmarkEvidenceCountsWhatLiesBeyondTheCore) {
  MapRules rules = Rules(0);
  rules.false_rate_per_m2 = 0.1;
  rules.no_landmark = 0.5;
  const LayeredGrid map = MapFromCounts(Points(1, 0, {{5, 5, 4}, {7, 5, 1}}), rules);
  const Perception perception = MakePerception(map, rules);
  EXPECT_NEAR(perception.likelihood.layers[0].At(5, 5), (0.1 + 0.9 * 0.8) * std::exp(-0.5 * 0.2), 1e-12);
  EXPECT_NEAR(perception.likelihood.layers[0].At(7, 5), (0.1 + 0.9 * 0.2) * std::exp(-0.5 * 0.8), 1e-12);
  EXPECT_NEAR(perception.outside[0], 0.1, 1e-12);
}

TEST(MakePerception, ExactModelIsTheProductOverTheRadius) {
  MapRules rules = Rules(0);
  rules.exact = true;
  const LayeredGrid map = MapFromCounts(Points(1, 0, {{5, 5, 4}, {7, 5, 1}, {5, 6, 1}}), rules);
  const double a = map.layers[0].At(5, 5), b = map.layers[0].At(7, 5), c = map.layers[0].At(5, 6);
  const Perception perception = MakePerception(map, rules);
  EXPECT_NEAR(perception.likelihood.layers[0].At(5, 5), a * (1 - b) * (1 - c), 1e-12);
  EXPECT_NEAR(perception.likelihood.layers[0].At(7, 5), b * (1 - a) * (1 - c), 1e-12);
  EXPECT_EQ(perception.outside[0], 0.0);
}

TEST(MakePerception, ALandmarkNeverSeenSaysNothing) {
  const Perception perception = MakePerception(MapFromCounts(Points(3, 1, {{5, 5, 4}}), Rules(2)), Rules(2));
  EXPECT_TRUE(perception.likelihood.layers[0].box.empty());
  EXPECT_GT(perception.outside[0], 0.0);
}

// Layer 0 has a name, layer 1 has none. 3 and 1 observations of the cell are 4 of it, 4 of the 6 within the
// radius; the layer with the name is the share of its own.
TEST(MapFromCounts, WhatHasNoNameMayBeWhatOthersName) {
  LayeredGrid counts = Points(2, 0, {{5, 5, 3}, {15, 15, 1}});
  counts.layers[1] = Points(2, 1, {{5, 5, 1}, {7, 5, 2}}).layers[1];
  MapRules rules = Rules(1);
  EXPECT_DOUBLE_EQ(MapFromCounts(counts, rules).layers[1].At(5, 5), 1.0 / 3.0);
  rules.partly_named = true;
  const LayeredGrid map = MapFromCounts(counts, rules);
  EXPECT_DOUBLE_EQ(map.layers[0].At(5, 5), 3.0 / 4.0);
  EXPECT_DOUBLE_EQ(map.layers[1].At(5, 5), 4.0 / 6.0);
  EXPECT_DOUBLE_EQ(map.layers[1].At(7, 5), 2.0 / 6.0);
  EXPECT_DOUBLE_EQ(map.layers[1].At(15, 15), 1.0);
}

TEST(MakePerception, ANameThatNobodyHasGivenSoFarMayBeAnyLandmarks) {
  MapRules rules = Rules(2);
  const LayeredGrid map = MapFromCounts(Points(3, 2, {{5, 5, 4}}), rules);
  EXPECT_TRUE(MakePerception(map, rules).Of(0).box.empty());
  rules.partly_named = rules.named_later = true;
  const Perception perception = MakePerception(map, rules);
  EXPECT_EQ(perception.LayerOf(0), 2U);
  EXPECT_GT(perception.Of(0).At(5, 5), 100.0 * perception.OutsideOf(0));
  LayeredGrid counts = Points(3, 1, {{5, 5, 4}});
  EXPECT_EQ(MakePerception(MapFromCounts(counts, rules), rules).LayerOf(1), 1U);
}

}  // namespace
}  // namespace cairn::landmark_map
