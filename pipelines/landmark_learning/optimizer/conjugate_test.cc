#include "pipelines/landmark_learning/optimizer/conjugate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

namespace cairn::landmark_learning {
namespace {

// (x - a)^T D (x - a) / 2 for a diagonal D: a long valley.
struct Valley {
  std::vector<double> at{3.0, -2.0, 1.0, 0.5}, stiff{1.0, 20.0, 4.0, 100.0};

  double Error(const std::vector<double>& x) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) sum += 0.5 * stiff[i] * (x[i] - at[i]) * (x[i] - at[i]);
    return sum;
  }
  std::vector<double> Gradient(const std::vector<double>& x) const {
    std::vector<double> g;
    for (std::size_t i = 0; i < x.size(); ++i) g.push_back(stiff[i] * (x[i] - at[i]));
    return g;
  }
};

std::vector<double> ErrorsAlong(const Valley& valley, const Conjugate& line, const std::vector<double>& x) {
  std::vector<double> errors;
  for (const double tried : Conjugate::kTried)
    errors.push_back(valley.Error(AlongLine(x, line.direction, line.length * tried)));
  return errors;
}

TEST(Conjugate, FindsTheBottomOfAValleyAndNeverGoesUp) {
  const Valley valley;
  std::vector<double> x(4, 0.0);
  Conjugate line;
  double before = valley.Error(x);
  for (int step = 0; step < 120 && !line.Stuck(); ++step) {
    line.Turn(before, valley.Gradient(x), 0.01);
    line = Read<Conjugate>(BlobOf(line));  // what travels
    const double taken = line.Choose(ErrorsAlong(valley, line, x));
    x = AlongLine(x, line.direction, taken);
    EXPECT_LE(valley.Error(x), before);
    before = valley.Error(x);
  }
  EXPECT_LT(before, 1e-4 * valley.Error(std::vector<double>(4, 0.0)));
}

TEST(Conjugate, BeginsDownTheGradientWithAStepOfTheSizeAskedFor) {
  Conjugate line;
  line.Turn(1.0, {3.0, -4.0}, 0.1);
  EXPECT_FLOAT_EQ(line.direction[0], -3.0F);
  EXPECT_FLOAT_EQ(line.direction[1], 4.0F);
  EXPECT_DOUBLE_EQ(line.slope, -25.0);
  EXPECT_NEAR(line.length * 5.0, 0.1 * std::sqrt(2.0), 1e-12);
}

// By hand: g = (1, 1) after g = (0, 2) along d = (0, -2): beta = ((1 + 1) - (0 + 2)) / 4 = 0, and
// g = (2, 1): beta = (5 - 2) / 4.
TEST(Conjugate, TurnsByPolakAndRibieresRule) {
  Conjugate line;
  line.Turn(1.0, {0.0, 2.0}, 0.1);
  Conjugate same = line;
  line.Turn(0.9, {1.0, 1.0}, 0.1);
  EXPECT_FLOAT_EQ(line.direction[0], -1.0F);
  EXPECT_FLOAT_EQ(line.direction[1], -1.0F);
  same.Turn(0.9, {2.0, 1.0}, 0.1);
  EXPECT_FLOAT_EQ(same.direction[0], -2.0F);
  EXPECT_FLOAT_EQ(same.direction[1], 0.75F * -2.0F - 1.0F);
}

// After a slope of -4 the next length is the one by which the error would fall as much were the line
// straight, but never more than ten times as long or as short.
TEST(Conjugate, TheNextLengthPromisesAsMuchAsTheLastOne) {
  const auto longer = [](std::vector<double> gradient) {
    Conjugate line;
    line.Turn(1.0, {2.0, 0.0}, 0.1);
    const double length = line.length, promised = length * line.slope;
    line.Turn(1.0, gradient, 0.1);
    return std::pair{line.length / length, line.length * line.slope / promised};
  };
  EXPECT_NEAR(longer({1.0, 0.0}).second, 1.0, 1e-6);
  EXPECT_NEAR(longer({0.7, -0.1}).second, 1.0, 1e-6);
  EXPECT_NEAR(longer({0.0, 3.0}).second, 1.0, 1e-6);
  EXPECT_NEAR(longer({0.01, 0.0}).first, 10.0, 1e-6);
  EXPECT_NEAR(longer({0.0, 40.0}).first, 0.1, 1e-6);
}

// Where the gradient vanishes there is no slope to tell how far to go next: the length stays.
TEST(Conjugate, AFlatPlaceTellsNothingOfTheLength) {
  Conjugate line;
  line.Turn(1.0, {3.0, -4.0}, 0.1);
  const double length = line.length;
  line.Turn(1.0, {0.0, 0.0}, 0.1);
  EXPECT_EQ(line.length, length);
  line.Turn(1.0, {0.0, 0.0}, 0.1);
  EXPECT_EQ(line.length, length);
  EXPECT_EQ(line.direction, (std::vector<float>{0.0F, 0.0F}));
}

// By hand: after (2, 0) the rule's direction for (-1, 1) is (-1, -1), along which the error stays as it is.
// Then it is the gradient's, from which all begins anew.
TEST(Conjugate, ADirectionThatDoesNotGoDownIsTheGradients) {
  Conjugate line;
  line.Turn(1.0, {2.0, 0.0}, 0.1);
  Conjugate other = line;
  line.Turn(0.9, {-1.0, 1.0}, 0.1);
  EXPECT_EQ(line.direction, (std::vector<float>{1.0F, -1.0F}));
  EXPECT_DOUBLE_EQ(line.slope, -2.0);
  EXPECT_EQ(line.since_restart, 0);
  other.Turn(0.9, {1.0, 2.0}, 0.1);  // beta = 3 / 4
  EXPECT_EQ(other.since_restart, 1);
  other.Turn(0.8, {0.5, 1.0}, 0.1);  // beta = 0: half as steep the same way
  EXPECT_EQ(other.since_restart, 0);
}

TEST(Conjugate, GivesUpWhereNothingIsLowerAfterSomeShorterTries) {
  Conjugate line;
  for (std::int64_t failure = 0; failure < Conjugate::kMostFailures; ++failure) {
    EXPECT_FALSE(line.Stuck());
    line.Turn(1.0, {1.0}, 0.1);
    const double length = line.length;
    EXPECT_EQ(line.Choose(std::vector<double>(Conjugate::kTried.size(), 1.0)), 0.0);
    EXPECT_LT(line.length, length);
  }
  EXPECT_TRUE(line.Stuck());
}

}  // namespace
}  // namespace cairn::landmark_learning
