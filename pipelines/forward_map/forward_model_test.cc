#include "pipelines/forward_map/forward_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pipelines/common/checked_readings.h"
#include "schema/rng.h"

namespace cairn::forward_map {
namespace {

constexpr SensorModel kModel{.p_hit = 0.6, .p_rand = 0.1, .sigma_m = 0.1, .no_echo_m = 0.05, .z_max_m = 5};

// 1 / (sigma sqrt(2 pi)) for the two widths.
constexpr double kPeak = 3.989422804014327, kPeakOfNoEcho = 7.978845608028654;

// [Thr01] figure 2: two obstacles in the cone, three peaks on a uniform floor.
TEST(Density, OfTwoObstaclesHasThePeaksOfFigure2) {
  const std::vector<double> obstacles = {1, 3};
  const double floor = 0.1 / 5;
  EXPECT_NEAR(Density(1, obstacles, kModel), floor + 0.9 * 0.6 * kPeak, 1e-12);
  EXPECT_NEAR(Density(3, obstacles, kModel), floor + 0.9 * 0.4 * 0.6 * kPeak, 1e-12);
  EXPECT_NEAR(Density(5, obstacles, kModel), floor + 0.9 * 0.4 * 0.4 * kPeakOfNoEcho, 1e-12);
  EXPECT_NEAR(Density(2, obstacles, kModel), floor, 1e-12);
  EXPECT_NEAR(Density(1.1, obstacles, kModel), floor + 0.9 * 0.6 * kPeak * std::exp(-0.5), 1e-12);
}

TEST(Density, OfAnEmptyConeIsNoEchoOrRandom) {
  EXPECT_NEAR(Density(5, {}, kModel), 0.02 + 0.9 * kPeakOfNoEcho, 1e-12);
  EXPECT_NEAR(Density(2, {}, kModel), 0.02, 1e-12);
}

// Echoes that are lost, with or without obstacles, put a floor under what has no echo.
TEST(Density, OfAnEchoThatMayBeLost) {
  SensorModel model = kModel;
  model.p_lost = 0.2;
  const std::vector<double> obstacles = {1, 3};
  EXPECT_NEAR(Density(5, obstacles, model), 0.02 + (0.2 + 0.7 * 0.4 * 0.4) * kPeakOfNoEcho, 1e-12);
  EXPECT_NEAR(Density(1, obstacles, model), 0.02 + 0.7 * 0.6 * kPeak, 1e-12);
  const Causes causes = Responsibilities(5, obstacles, model);
  EXPECT_NEAR(causes.lost / causes.none, 0.2 / (0.7 * 0.4 * 0.4), 1e-12);
}

// What lies beyond the map may be anywhere; the obstacles before it were passed.
TEST(Density, OfAnEndBeyondTheMap) {
  const std::vector<double> obstacles = {1};
  EXPECT_NEAR(Density(2, obstacles, kModel, End::kBeyond), 0.02 + 0.9 * 0.4 / 5, 1e-12);
  EXPECT_NEAR(Density(1, obstacles, kModel, End::kBeyond), 0.02 + 0.9 * (0.6 * kPeak + 0.4 / 5), 1e-12);
  EXPECT_NEAR(Responsibilities(2, obstacles, kModel, End::kBeyond).none, 0.072 / 0.092, 1e-12);
}

// The model gives mass beyond z_max to [Thr01] eq. 6 and none is renormalised: up to there, half of that peak
// is missing.
TEST(Density, IntegratesToOneButForWhatLiesBeyondTheReach) {
  for (const auto& obstacles : {std::vector<double>{}, {2.5}, {1, 1.05, 3}}) {
    constexpr int kSteps = 500000;
    const double step = kModel.z_max_m / kSteps;
    double mass = 0;
    for (int i = 0; i < kSteps; ++i) mass += step * Density((i + 0.5) * step, obstacles, kModel);
    const double beyond = 0.9 * std::pow(0.4, obstacles.size()) / 2;
    EXPECT_NEAR(mass + beyond, 1, 1e-6) << obstacles.size();
  }
}

TEST(Responsibilities, AreBayesRuleByHand) {
  const Causes causes = Responsibilities(1.1, std::vector<double>{1, 1.2}, kModel);
  const double near = 0.9 * 0.6 * kPeak * std::exp(-0.5), far = 0.4 * near, random = 0.02;
  EXPECT_NEAR(causes.obstacle[0], near / (near + far + random), 1e-12);
  EXPECT_NEAR(causes.obstacle[1], far / (near + far + random), 1e-12);
  EXPECT_NEAR(causes.random, random / (near + far + random), 1e-12);
  EXPECT_EQ(causes.none, 0);
}

// [Thr01] eq. 11 = log p(Z | m) - H(C | Z, m): what EM climbs, and what it leaves out.
TEST(ExpectedLogLikelihood, IsTheLogLikelihoodLessTheEntropyOfTheCauses) {
  Rng rng(3);
  SensorModel model = kModel;
  for (int trial = 0; trial < 200; ++trial) {
    model.p_lost = trial % 2 == 0 ? 0 : 0.1;
    std::vector<double> obstacles;
    for (double d = rng.Uniform(0, 1); d < 5; d += rng.Uniform(0, 1)) obstacles.push_back(d);
    const double z = trial % 7 == 0 ? kModel.z_max_m : rng.Uniform(0, 5);
    const Causes causes = Responsibilities(z, obstacles, model);
    double sum = causes.random + causes.lost + causes.none;
    for (const double k : causes.obstacle) sum += k;
    EXPECT_NEAR(sum, 1, 1e-12);
    EXPECT_NEAR(ExpectedLogLikelihood(z, obstacles, model, causes) + Entropy(causes),
                std::log(Density(z, obstacles, model)), 1e-10);
  }
}

// Any other distribution over the causes gives less: the bound that makes EM climb.
TEST(ExpectedLogLikelihood, WithEntropyIsABoundThatOnlyTheEStepReaches) {
  const std::vector<double> obstacles = {1, 1.2};
  Causes other = Responsibilities(1.1, obstacles, kModel);
  other.obstacle[0] -= 0.1;
  other.random += 0.1;
  EXPECT_LT(ExpectedLogLikelihood(1.1, obstacles, kModel, other) + Entropy(other),
            std::log(Density(1.1, obstacles, kModel)) - 1e-3);
}

// What checks maps, and knows nothing of this code, says the same of maps whose cells are occupied or free.
TEST(Density, IsThatByWhichMapsAreChecked) {
  const SensorModel model{0.6, 0.1, 0.05, 0.2, 0.3, 8};
  const ReadingModel same{0.6, 0.1, 0.05, 0.2, 0.3, 8, true};
  const std::vector<double> obstacles = {1, 2.5, 2.75, 7.9};
  std::vector<MetCell> cells = {{0.5, 0}, {4, 0}};
  for (const double distance_m : obstacles) cells.push_back({distance_m, 1});
  std::ranges::sort(cells, {}, &MetCell::distance_m);
  for (double z_m = 0; z_m <= 8; z_m += 0.125) {
    for (const End end : {End::kInMap, End::kBeyond}) {
      const double density = Density(z_m, obstacles, model, end);
      EXPECT_NEAR(DensityOf(z_m, cells, same, end == End::kBeyond), density, 1e-12 * density) << z_m;
    }
  }
}

}  // namespace
}  // namespace cairn::forward_map
