#include "pipelines/landmark_learning/optimizer/descent.h"

#include <gtest/gtest.h>

#include <cmath>

#include "schema/error.h"

namespace cairn::landmark_learning {
namespace {

TEST(Descent, TakesTheStepsByHand) {
  std::vector<double> w{1.0, -2.0};
  Descent plain;
  plain.Step({.method = Method::kGradient, .rate = 0.1}, {3.0, -1.0}, &w);
  EXPECT_NEAR(w[0], 0.7, 1e-15);
  EXPECT_NEAR(w[1], -1.9, 1e-15);

  w = {0.0};
  Descent momentum;
  const DescentRules rules{.method = Method::kMomentum, .rate = 0.125, .momentum = 0.5};  // whole in a float
  momentum.Step(rules, {1.0}, &w);
  momentum.Step(rules, {1.0}, &w);
  EXPECT_NEAR(w[0], -0.125 - 0.1875, 1e-15);

  w = {0.0, 0.0};
  Descent adam;  // the first step is the rate, whatever the gradient's size
  adam.Step({.method = Method::kAdam, .rate = 0.01}, {1e-3, -50.0}, &w);
  EXPECT_NEAR(w[0], -0.01, 1e-6);
  EXPECT_NEAR(w[1], 0.01, 1e-6);
}

TEST(Descent, DecayPullsTowardsZeroBesideTheStep) {
  std::vector<double> w{2.0};
  Descent descent;
  descent.Step({.method = Method::kGradient, .rate = 0.5, .weight_decay = 0.1}, {0.0}, &w);
  EXPECT_NEAR(w[0], 2.0 - 0.5 * 0.1 * 2.0, 1e-15);
}

// Every method finds the bottom of a bowl.
TEST(Descent, FindsTheLeastSquare) {
  for (const Method method : {Method::kGradient, Method::kMomentum, Method::kAdam}) {
    std::vector<double> w{3.0, -1.0};
    Descent descent;
    for (int i = 0; i < 3000; ++i)
      descent.Step({method, 0.01, 0.9, 0.0}, {2.0 * (w[0] - 1.0), 8.0 * (w[1] - 0.5)}, &w);
    EXPECT_NEAR(w[0], 1.0, 1e-3) << static_cast<int>(method);
    EXPECT_NEAR(w[1], 0.5, 1e-3) << static_cast<int>(method);
  }
}

TEST(Descent, ComesBackAsItWasStored) {
  std::vector<double> w{1.0, 2.0}, same = w;
  Descent descent;
  descent.Step({}, {0.5, -0.5}, &w);
  Descent back = Read<Descent>(BlobOf(descent));
  same = w;
  descent.Step({}, {0.1, 0.2}, &w);
  back.Step({}, {0.1, 0.2}, &same);
  EXPECT_EQ(w, same);
  Blob torn = BlobOf(descent);
  torn.PutVector("second", std::vector<double>{1.0, 2.0});
  EXPECT_THROW(Read<Descent>(torn), InputError);
}

}  // namespace
}  // namespace cairn::landmark_learning
