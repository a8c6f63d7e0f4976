#include "pipelines/landmark_map/model/landmark_classes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "pipelines/landmark_map/landmarks/summary.h"
#include "pipelines/landmark_map/model/m_step.h"

namespace cairn::landmark_map {
namespace {

ClassRules Two() { return {2, {0.9, 0.1, 0.2, 0.8}}; }

MapRules RulesOfClasses() {
  MapRules rules;
  rules.grid = {1.0, 4};
  rules.classes = Two();
  rules.observation_m = 0.0;
  rules.radius_m = 3.0;
  rules.core_m = 1.0;
  rules.no_landmark = 0.0;
  return rules;
}

// [class][x][y] of what was seen: two observations at (5, 5) that seemed of class 0, one of class 1.
LayeredGrid Counts() {
  LayeredGrid counts;
  counts.layers.assign(2, Layer(Box{0, 0, 20, 20}));
  counts.layers[0].Row(5)[5] = 2;
  counts.layers[1].Row(5)[5] = 1;
  counts.layers[1].Row(15)[15] = 3;
  return counts;
}

// Bayes by hand: 0.9^2 * 0.1 against 0.2^2 * 0.8.
TEST(ClassPosterior, IsBayesRule) {
  const std::vector<double> p = ClassPosterior({2, 1}, Two());
  EXPECT_NEAR(p[0], 0.081 / (0.081 + 0.032), 1e-12);
  EXPECT_NEAR(p[0] + p[1], 1, 1e-12);
  EXPECT_NEAR(ClassPosterior({0, 0}, Two())[0], 0.5, 1e-12);
}

TEST(ClassPosterior, OfManyObservationsIsNoNan) { EXPECT_NEAR(ClassPosterior({1e6, 0}, Two())[0], 1, 1e-12); }

// 3 of 3 observations are at (5, 5), whatever they seemed.
TEST(MapFromCounts, SplitsWhatIsThereAmongTheClasses) {
  const LayeredGrid map = MapFromCounts(Counts(), RulesOfClasses());
  ASSERT_EQ(map.layers.size(), 2U);
  EXPECT_NEAR(map.layers[0].At(5, 5), 0.081 / 0.113, 1e-9);
  EXPECT_NEAR(map.layers[1].At(5, 5), 0.032 / 0.113, 1e-9);
  EXPECT_NEAR(map.layers[1].At(15, 15), 0.512 / (0.512 + 0.001), 1e-9);
}

// P(seems 0) = 0.9 * P(is 0) + 0.2 * P(is 1), and half of a false observation's chance.
TEST(MakePerception, ClassesMayBeTakenForOneAnother) {
  const MapRules rules = RulesOfClasses();
  const LayeredGrid map = MapFromCounts(Counts(), rules);
  const Perception perception = MakePerception(map, rules);
  const double eps = rules.false_rate_per_m2, is0 = map.layers[0].At(5, 5), is1 = map.layers[1].At(5, 5);
  EXPECT_NEAR(perception.likelihood.layers[0].At(5, 5), eps / 2 + (1 - eps) * (0.9 * is0 + 0.2 * is1), 1e-12);
  EXPECT_NEAR(perception.likelihood.layers[1].At(5, 5), eps / 2 + (1 - eps) * (0.1 * is0 + 0.8 * is1), 1e-12);
  EXPECT_DOUBLE_EQ(perception.outside[0], eps / 2);
}

// A confusion that tells nothing must not change where landmarks are.
TEST(MakePerception, ClassesThatTellNothingLeaveTheMapAsItIs) {
  MapRules deaf = RulesOfClasses(), one = RulesOfClasses();
  deaf.classes.confusion = {0.5, 0.5, 0.5, 0.5};
  one.classes = {};
  LayeredGrid together;
  together.layers.push_back(CountsOfAllClasses(Counts(), 0, Two()));
  const Perception two = MakePerception(MapFromCounts(Counts(), deaf), deaf),
                   plain = MakePerception(MapFromCounts(together, one), one);
  for (const int at : {5, 15}) {
    EXPECT_NEAR(two.likelihood.layers[0].At(at, at), plain.likelihood.layers[0].At(at, at) / 2, 1e-9);
    EXPECT_NEAR(two.likelihood.layers[1].At(at, at), plain.likelihood.layers[0].At(at, at) / 2, 1e-9);
  }
}

TEST(ExtractLandmarks, ALandmarkHasOneClass) {
  const std::vector<Landmark> landmarks = ExtractLandmarks(Counts(), RulesOfClasses());
  ASSERT_EQ(landmarks.size(), 2U);
  for (const Landmark& l : landmarks) {
    EXPECT_EQ(l.landmark_class, l.x_m < 10 ? 0 : 1);
    EXPECT_NEAR(l.count, 3, 1e-9);
    EXPECT_EQ(l.type, 0);
  }
}

}  // namespace
}  // namespace cairn::landmark_map
