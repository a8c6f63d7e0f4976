#include "pipelines/landmark_map/landmarks/summary.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "schema/rng.h"

namespace cairn::landmark_map {
namespace {

TEST(Summarise, GivesMeanCovarianceAndModeAcrossTheWrap) {
  const GridSpec grid{0.5, 8};
  LayeredGrid belief;
  belief.layers.resize(8);
  for (const int c : {0, 7}) {  // 0 and -45 degrees
    belief.layers[c] = Layer(Box{2, 4, 2, 1});
    belief.layers[c].values = {0.1, c == 0 ? 0.5 : 0.3};
  }
  const PoseSummary pose = Summarise(belief, grid);
  EXPECT_NEAR(pose.x_m, (2 * 0.2 + 3 * 0.8) * 0.5, 1e-12);
  EXPECT_NEAR(pose.y_m, 2.0, 1e-12);
  EXPECT_LT(pose.heading_rad, 0.0);
  EXPECT_GT(pose.heading_rad, -std::numbers::pi / 4);
  EXPECT_NEAR(pose.covariance[0], 0.2 * 0.8 * 0.25, 1e-12);
  EXPECT_NEAR(pose.covariance[4], 0.0, 1e-12);
  EXPECT_NEAR(pose.mode_y_m, 2.0, 1e-12);
  EXPECT_GT(pose.mode_x_m, 1.25);
}

// A belief over three headings about layer `c` and a few cells, of random weights.
LayeredGrid Scattered(int headings, int c, std::uint64_t seed) {
  Rng rng(seed);
  LayeredGrid belief;
  belief.layers.resize(static_cast<std::size_t>(headings));
  for (int k = -1; k <= 1; ++k) {
    Layer layer(Box{3 + k, -7, 4, 3});
    for (double& value : layer.values) value = rng.Uniform();
    belief.layers[static_cast<std::size_t>((c + k + headings) % headings)] = std::move(layer);
  }
  belief.Scale(1.0 / belief.Sum());
  return belief;
}

// Mean and covariance by their definition: E[v] and E[v v'] - E[v] E[v]', headings counted from layer `c`, as
// they are few and small.
TEST(MeanPosition, IsThatOfTheSummary) {
  const GridSpec grid{0.5, 72};
  LayeredGrid belief = Scattered(grid.headings, 20, 1);
  belief.layers[3] = Layer(Box{-9, 2, 7, 2});
  for (int i = 0; i < 14; ++i) belief.layers[3].values[static_cast<std::size_t>(i)] = 0.01 * i;
  const PoseSummary pose = Summarise(belief, grid);
  const Point mean = MeanPosition(belief, grid);
  EXPECT_NEAR(mean.x_m, pose.x_m, 1e-12);
  EXPECT_NEAR(mean.y_m, pose.y_m, 1e-12);
}

TEST(Summarise, TheCovarianceIsTheMeanOfProductsLessTheProductOfMeans) {
  const GridSpec grid{0.5, 72};
  const double step = 2.0 * std::numbers::pi / grid.headings;
  const LayeredGrid belief = Scattered(grid.headings, 20, 1);
  double mean[3] = {}, product[3][3] = {};
  for (int k = -1; k <= 1; ++k) {
    const Layer& layer = belief.layers[static_cast<std::size_t>(20 + k)];
    for (int y = -7; y < -4; ++y) {
      for (int x = 3 + k; x < 7 + k; ++x) {
        const double v[3] = {x * grid.cell_m, y * grid.cell_m, k * step};
        for (int a = 0; a < 3; ++a) {
          mean[a] += layer.At(x, y) * v[a];
          for (int b = 0; b < 3; ++b) product[a][b] += layer.At(x, y) * v[a] * v[b];
        }
      }
    }
  }
  const PoseSummary pose = Summarise(belief, grid);
  EXPECT_NEAR(pose.x_m, mean[0], 1e-12);
  EXPECT_NEAR(pose.y_m, mean[1], 1e-12);
  EXPECT_NEAR(pose.heading_rad, 20 * step + mean[2], 1e-5);  // a circular mean
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b)
      EXPECT_NEAR(pose.covariance[3 * a + b], product[a][b] - mean[a] * mean[b], 1e-6) << a << b;
  }
  EXPECT_GT(std::abs(pose.covariance[1]), 1e-3);
  EXPECT_GT(std::abs(pose.covariance[5]), 1e-4);
}

// The mode of a belief that is one bump is its mean, to a fraction of a cell, wherever it lies and faces: at
// (0.3, -0.2) cells and 0.25 headings from a cell's middle.
TEST(Summarise, TheModeOfABumpIsItsMean) {
  const GridSpec grid{0.4, 24};
  const double step = 2.0 * std::numbers::pi / grid.headings;
  for (const int c : {0, 7, 12, 23}) {
    LayeredGrid belief;
    belief.layers.resize(24);
    for (int k = -1; k <= 1; ++k) {
      Layer layer(Box{-4, 8, 3, 3});
      const double heading[3] = {0.1, 0.55, 0.35}, along[3] = {0.05, 0.6, 0.35}, across[3] = {0.3, 0.6, 0.1};
      for (int y = 8; y < 11; ++y) {
        for (int x = -4; x < -1; ++x) layer.Row(y)[x] = heading[k + 1] * along[x + 4] * across[y - 8];
      }
      belief.layers[static_cast<std::size_t>((c + k + 24) % 24)] = std::move(layer);
    }
    const PoseSummary pose = Summarise(belief, grid);
    EXPECT_NEAR(pose.mode_x_m, (-3 + 0.3) * grid.cell_m, 1e-12);
    EXPECT_NEAR(pose.mode_y_m, (9 - 0.2) * grid.cell_m, 1e-12);
    EXPECT_NEAR(std::remainder(pose.mode_heading_rad - (c + 0.25) * step, 2.0 * std::numbers::pi), 0.0,
                1e-12);
    EXPECT_NEAR(std::remainder(pose.mode_heading_rad - pose.heading_rad, 2.0 * std::numbers::pi), 0.0, 0.01);
  }
}

LayeredGrid Counts(const std::vector<std::array<double, 3>>& points) {
  LayeredGrid counts;
  counts.layers.emplace_back(Box{-20, -20, 60, 60});
  for (const auto& [x, y, c] : points) counts.layers[0].Row(static_cast<int>(y))[static_cast<int>(x)] += c;
  return counts;
}

TEST(ExtractLandmarks, JoinsACoreAndDropsWhatIsLessThanHalfAnObservation) {
  MapRules rules;
  rules.grid = {1.0, 4};
  rules.core_m = 2.5;
  const std::vector<Landmark> landmarks =
      ExtractLandmarks(Counts({{0, 0, 2}, {1, 0, 2}, {20, 3, 1.0}, {30, 30, 0.4}}), rules);
  ASSERT_EQ(landmarks.size(), 2U);
  EXPECT_NEAR(landmarks[0].x_m, 0.5, 1e-12);
  EXPECT_NEAR(landmarks[0].count, 4.0, 1e-12);
  EXPECT_NEAR(landmarks[0].covariance_m2[0], 0.25 + 1.0 / 12, 1e-12);
  EXPECT_NEAR(landmarks[1].x_m, 20.0, 1e-12);
}

// Three contact detections in cells about (4, -3), by hand, on grids of several sizes: all lengths grow with
// the cell.
TEST(ExtractLandmarks, ALandmarksCovarianceIsThatOfItsContactsAndOfACellInMetres) {
  for (const double cell_m : {0.25, 1.0, 3.0}) {
    MapRules rules;
    rules.grid = {cell_m, 4};
    rules.core_m = 2.5 * cell_m;
    const std::vector<Landmark> landmarks =
        ExtractLandmarks(Counts({{3, -4, 1}, {4, -3, 1}, {5, -3, 1}}), rules);
    ASSERT_EQ(landmarks.size(), 1U);
    EXPECT_NEAR(landmarks[0].x_m, 4.0 * cell_m, 1e-12);
    EXPECT_NEAR(landmarks[0].y_m, -10.0 / 3.0 * cell_m, 1e-12);
    const double area = cell_m * cell_m;
    EXPECT_NEAR(landmarks[0].covariance_m2[0], (2.0 / 3.0 + 1.0 / 12.0) * area, 1e-12);
    EXPECT_NEAR(landmarks[0].covariance_m2[1], 1.0 / 3.0 * area, 1e-12);
    EXPECT_NEAR(landmarks[0].covariance_m2[2], 1.0 / 3.0 * area, 1e-12);
    EXPECT_NEAR(landmarks[0].covariance_m2[3], (2.0 / 9.0 + 1.0 / 12.0) * area, 1e-12);
  }
}

// A single cell of 0.45 stands higher than 0.7 spread over a disc, but it is no landmark; the disc is.
TEST(ExtractLandmarks, ANarrowPeakThatIsNoLandmarkHidesNoOther) {
  MapRules rules;
  rules.grid = {1.0, 4};
  rules.core_m = 2.5;
  std::vector<std::array<double, 3>> points = {{30, 30, 0.45}};
  for (int y = -2; y <= 2; ++y) {
    for (int x = -2; x <= 2; ++x) {
      if (x * x + y * y <= 4) points.push_back({double(x), double(y), 0.7 / 13});
    }
  }
  const std::vector<Landmark> landmarks = ExtractLandmarks(Counts(points), rules);
  ASSERT_EQ(landmarks.size(), 1U);
  EXPECT_NEAR(landmarks[0].count, 0.7, 1e-9);
}

// Of a core of five cells: (3, 4) and (-3, -4) lie five cells off, on its rim, which belongs to it as in
// ExtractLandmarks; (4, 4) lies beyond.
TEST(LeaveOut, TakesAllThatTheLandmarkCountedTheRimOfItsCoreToo) {
  MapRules rules;
  rules.grid = {1.0, 4};
  rules.core_m = 5.0;
  LayeredGrid counts = Counts({{0, 0, 2.0}, {3, 4, 1.0}, {-3, -4, 1.0}, {4, 4, 0.25}});
  const std::vector<Landmark> landmarks = ExtractLandmarks(counts, rules);
  ASSERT_EQ(landmarks.size(), 1U);
  EXPECT_EQ(landmarks[0].count, 2.0 + 1.0 + 1.0);
  const std::vector<double> taken = LeaveOut(landmarks[0], rules, &counts);
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_EQ(taken[0], landmarks[0].count);
  EXPECT_EQ(counts.Sum(), 0.25);
}

TEST(Associate, TakesTheNearestLandmarkOfTheTypeWithinReach) {
  const std::vector<Landmark> landmarks = {{0, 0, {}, 0, 1}, {4, 0, {}, 0, 1}, {4, 0.5, {}, 1, 1}};
  Layer where(Box{0, 0, 6, 1});
  where.values = {0.1, 0.2, 0.0, 0.3, 0.4, 0.0};
  const Association a = Associate(where, 0, landmarks, 1.0, 3.0);
  EXPECT_EQ(a.landmark, 1);
  EXPECT_NEAR(a.probability, 0.7, 1e-12);
  Layer far(Box{30, 0, 1, 1});
  far.values = {1.0};
  EXPECT_EQ(Associate(far, 0, landmarks, 1.0, 3.0).landmark, -1);
}

TEST(Associate, NothingIsSurerThanCertain) {
  const std::vector<Landmark> landmarks = {{0, 0, {}, 0, 1}};
  Layer where(Box{0, 0, 3, 1});
  where.values = {0.7, 0.2, 0.1 + 1e-15};
  ASSERT_GT(where.values[0] + where.values[1] + where.values[2], 1.0);
  EXPECT_EQ(Associate(where, 0, landmarks, 1.0, 3.0).probability, 1.0);
  Layer far(Box{30, 0, 3, 1});
  far.values = where.values;
  EXPECT_EQ(Associate(far, 0, landmarks, 1.0, 3.0).probability, 1.0) << "of there being none";
}

// Of the nameless observations two lie within the core of the landmark that has a name, three beside it.
TEST(ExtractLandmarks, WhatHasNoNameIsTheNamedLandmarksThatItLiesOn) {
  MapRules rules;
  rules.grid = {1.0, 4};
  rules.core_m = 2.5;
  rules.types = 1;
  LayeredGrid counts = Counts({{0, 0, 4}});
  counts.layers.push_back(Counts({{1, 0, 2}, {6, 0, 3}}).layers[0]);
  EXPECT_EQ(ExtractLandmarks(counts, rules).size(), 3U);
  rules.partly_named = true;
  const std::vector<Landmark> landmarks = ExtractLandmarks(counts, rules);
  ASSERT_EQ(landmarks.size(), 2U);
  EXPECT_EQ(landmarks[0].type, 0);
  EXPECT_DOUBLE_EQ(landmarks[0].count, 6.0);
  EXPECT_EQ(landmarks[1].type, 1);
  EXPECT_DOUBLE_EQ(landmarks[1].x_m, 6.0);
  rules.observation_m = 1.3;
  EXPECT_EQ(ExtractLandmarks(counts, rules).size(), 2U) << "three are a landmark, wherever it stands";
  counts.layers[1].Row(0)[6] = 1.9;
  EXPECT_EQ(ExtractLandmarks(counts, rules).size(), 1U);
  EXPECT_EQ(LeaveOut(landmarks[0], rules, &counts), (std::vector<double>{4.0, 2.0}));
  Layer where(Box{1, 0, 1, 1});
  where.values = {1.0};
  EXPECT_EQ(Associate(where, 1, landmarks, 1.0, 3.0).landmark, -1);
  EXPECT_EQ(Associate(where, kOfAnyType, landmarks, 1.0, 3.0).landmark, 0);
}

}  // namespace
}  // namespace cairn::landmark_map
