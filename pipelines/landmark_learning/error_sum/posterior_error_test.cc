#include "pipelines/landmark_learning/error_sum/posterior_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "pipelines/landmark_learning/error_sum/features.h"
#include "schema/rng.h"

namespace cairn::landmark_learning {
namespace {

constexpr double kEverywhere = std::numeric_limits<double>::infinity();

struct World {
  Positions positions;
  std::vector<double> g, weight;
  int networks;

  World(int samples, int n, std::uint64_t seed) : networks(n) {
    Rng rng(seed);
    double x = 0.0, y = 0.0, along = 0.0;
    for (int k = 0; k < samples; ++k) {
      positions.x_m.push_back(x += rng.Uniform(0.0, 0.7));
      positions.y_m.push_back(y += rng.Uniform(-0.3, 0.3));
      positions.along_m.push_back(along += rng.Uniform(0.0, 1.0));
      for (int i = 0; i < n; ++i) g.push_back(rng.Uniform());
      weight.push_back(rng.Uniform(0.5, 1.5) / samples);
    }
    Rng headings(seed, 1);
    for (int k = 0; k < samples; ++k) {  // there and back, more or less
      const double heading = (headings.Uniform() < 0.5 ? 0.0 : 3.0) + headings.Uniform(-0.6, 0.6);
      positions.cos_heading.push_back(std::cos(heading));
      positions.sin_heading.push_back(std::sin(heading));
    }
  }
  std::vector<double> G() const { return FeatureProbabilities(g, networks); }
  ErrorShare<double> Share(const Belief& belief, const ErrorRule& error,
                           const IndexRange& true_positions) const {
    return ErrorOfTruePositions(Pairs(positions, positions, belief, error), G(), 1 << networks, weight,
                                true_positions);
  }
  double Prior(const Belief& belief, const IndexRange& true_positions) const {
    return PriorErrorOfTruePositions(Pairs(positions, positions, belief, ErrorKind::kDistance), weight,
                                     true_positions);
  }
  ErrorShare<double> All(const Belief& belief, const ErrorRule& error) const {
    return Share(belief, error, {0, positions.size()});
  }
};

double ErrorBetween(const Positions& p, ErrorKind kind, std::size_t a, std::size_t k) {
  const double distance = std::hypot(p.x_m[a] - p.x_m[k], p.y_m[a] - p.y_m[k]);
  if (kind == ErrorKind::kAlong) return std::abs(p.along_m[a] - p.along_m[k]);
  return kind == ErrorKind::kDistance ? distance : distance * distance;
}

double BeliefIn(const Positions& p, const Belief& belief, std::size_t a, std::size_t k) {
  const double distance = std::hypot(p.x_m[a] - p.x_m[k], p.y_m[a] - p.y_m[k]);
  if (distance > belief.ReachM()) return 0.0;
  const double turned = std::remainder(
      std::atan2(p.sin_heading[a], p.cos_heading[a]) - std::atan2(p.sin_heading[k], p.cos_heading[k]),
      2 * std::numbers::pi);
  if (std::abs(turned) > belief.heading_rad) return 0.0;
  return belief.shape == BeliefShape::kUniform
             ? 1.0
             : std::exp(-0.5 * distance * distance / belief.width_m / belief.width_m);
}

double P(const World& w, std::size_t f, std::size_t k) {
  double p = 1.0;
  for (int i = 0; i < w.networks; ++i) {
    const double g = w.g[k * static_cast<std::size_t>(w.networks) + static_cast<std::size_t>(i)];
    p *= (f >> i) & 1 ? g : 1.0 - g;
  }
  return p;
}

// [Thr98] eq. 42 with the denominator of [Thr98] eq. 37, literally: for each truth, sample and feature vector
// the sum over all samples again.
double LiteralError(const World& w, const Belief& belief, ErrorKind kind) {
  const auto samples = static_cast<std::size_t>(w.positions.size());
  double error = 0.0;
  for (std::size_t a = 0; a < samples; ++a) {
    for (std::size_t k = 0; k < samples; ++k) {
      const double factor =
          ErrorBetween(w.positions, kind, a, k) * w.weight[a] * BeliefIn(w.positions, belief, a, k);
      for (std::size_t f = 0; f < FeatureVectors(w.networks); ++f) {
        double z = 0.0;
        for (std::size_t other = 0; other < samples; ++other)
          z += P(w, f, other) * BeliefIn(w.positions, belief, a, other);
        if (z > 0.0) error += factor * P(w, f, a) * P(w, f, k) / z;
      }
    }
  }
  return error;
}

const Belief kBeliefs[] = {{BeliefShape::kUniform, 2.0},
                           {BeliefShape::kUniform, kEverywhere},
                           {BeliefShape::kGaussian, 1.5},
                           {BeliefShape::kUniform, 2.0, 0.5},
                           {BeliefShape::kUniform, kEverywhere, 1.5},
                           {BeliefShape::kGaussian, 1.5, 1.5}};
constexpr ErrorKind kErrors[] = {ErrorKind::kDistance, ErrorKind::kSquaredDistance, ErrorKind::kAlong};

TEST(PosteriorError, EqualsTheLiteralSumOverTriples) {
  for (const Belief& belief : kBeliefs) {
    for (const ErrorKind kind : kErrors) {
      for (int networks = 1; networks <= 3; ++networks) {
        const World world(40, networks, 3);
        const double literal = LiteralError(world, belief, kind);
        EXPECT_NEAR(world.All(belief, kind).posterior, literal, 1e-10 * literal) << networks;
      }
    }
  }
}

// -log of the mass that a bell around the truth weighs, literally.
double LiteralMassCost(const World& w, const Belief& belief, double smooth_m) {
  const auto samples = static_cast<std::size_t>(w.positions.size());
  double error = 0.0;
  for (std::size_t a = 0; a < samples; ++a) {
    for (std::size_t f = 0; f < FeatureVectors(w.networks); ++f) {
      double mass = 0.0, z = 0.0;
      for (std::size_t k = 0; k < samples; ++k) {
        const double d = ErrorBetween(w.positions, ErrorKind::kDistance, a, k);
        const double believed = P(w, f, k) * BeliefIn(w.positions, belief, a, k);
        mass += std::exp(-0.5 * d * d / (smooth_m * smooth_m)) * believed;
        z += believed;
      }
      error -= w.weight[a] * P(w, f, a) * std::log((1.0 - 1e-6) * mass / z + 1e-6);
    }
  }
  return error;
}

TEST(PosteriorError, OfMassIsTheLiteralLogarithmOfWhatTheBellHolds) {
  for (const Belief& belief : kBeliefs) {
    for (const double smooth_m : {0.3, 2.0}) {
      const World world(40, 3, 4);
      const double literal = LiteralMassCost(world, belief, smooth_m);
      EXPECT_GT(literal, 0.0);
      const ErrorRule rule(ErrorKind::kPosteriorMass, smooth_m);
      EXPECT_NEAR(world.All(belief, rule).posterior, literal, 1e-9 * literal);
      const Pairs pairs(world.positions, world.positions, belief, rule);
      EXPECT_NEAR(ErrorInMap(pairs, world.G(), world.G(), 8, world.weight, {0, 40}), literal, 1e-9 * literal);
      EXPECT_GT(PriorErrorOfTruePositions(pairs, world.weight, {0, 40}), literal);
    }
  }
}

// The bound: 1e-6 of max(|gradient|, a thousandth of the largest).
void ExpectTheGradient(const Belief& belief, const ErrorRule& rule) {
  World world(150, 4, 5);
  const auto share = world.All(belief, rule);
  const auto gradient = OutputGradient(world.g, 4, share.d_probability);
  double largest = 0.0;
  for (const double slope : gradient) largest = std::max(largest, std::abs(slope));
  ASSERT_GT(largest, 0.0);
  for (std::size_t i = 0; i < world.g.size(); i += 37) {
    const double at = world.g[i];
    const auto error_at = [&](double step) {
      world.g[i] = at + step;
      const double error = world.All(belief, rule).posterior;
      world.g[i] = at;
      return error;
    };
    constexpr double kStep = 3e-4;  // of fourth order, or what is cut off of the series would be seen
    const double slope =
        (8.0 * (error_at(kStep) - error_at(-kStep)) - (error_at(2 * kStep) - error_at(-2 * kStep))) /
        (12.0 * kStep);
    EXPECT_NEAR(gradient[i], slope, 1e-6 * std::max(std::abs(gradient[i]), 1e-3 * largest)) << i;
  }
}

TEST(PosteriorError, TheGradientIsThatOfFiniteDifferences) {
  for (const Belief& belief : kBeliefs) {
    ExpectTheGradient(belief, ErrorKind::kDistance);
    ExpectTheGradient(belief, {ErrorKind::kPosteriorMass, 0.7});
  }
}

TEST(PosteriorError, BlocksOfTruePositionsAddUp) {
  const World world(200, 3, 7);
  const auto whole = world.All(kBeliefs[0], ErrorKind::kDistance);
  ErrorShare<double> sum;
  double prior = 0.0;
  sum.d_probability.assign(whole.d_probability.size(), 0.0);
  for (const IndexRange& block : {IndexRange{0, 61}, IndexRange{61, 62}, IndexRange{62, 200}}) {
    const auto share = world.Share(kBeliefs[0], ErrorKind::kDistance, block);
    sum.posterior += share.posterior;
    prior += world.Prior(kBeliefs[0], block);
    for (std::size_t i = 0; i < sum.d_probability.size(); ++i) sum.d_probability[i] += share.d_probability[i];
  }
  EXPECT_NEAR(sum.posterior, whole.posterior, 1e-12);
  EXPECT_NEAR(prior, world.Prior(kBeliefs[0], {0, 200}), 1e-12);
  for (std::size_t i = 0; i < sum.d_probability.size(); ++i)
    EXPECT_NEAR(sum.d_probability[i], whole.d_probability[i], 1e-12);
}

// A line of 89 m under a uniform belief: 29.7 m, a third of its length.
TEST(PosteriorError, FeaturesThatTellNothingLeaveThePrior) {
  World world(90, 2, 1);
  for (int k = 0; k < 90; ++k) {
    world.positions.x_m[static_cast<std::size_t>(k)] = k;
    world.positions.y_m[static_cast<std::size_t>(k)] = 0.0;
    world.weight[static_cast<std::size_t>(k)] = 1.0 / 90;
  }
  world.g.assign(world.g.size(), 0.5);
  const auto share = world.All({BeliefShape::kUniform, kEverywhere}, ErrorKind::kDistance);
  const double prior = world.Prior({BeliefShape::kUniform, kEverywhere}, {0, 90});
  EXPECT_NEAR(prior, 89.0 / 3.0, 0.4);
  EXPECT_NEAR(share.posterior, prior, 1e-9);
}

TEST(PosteriorError, FeaturesThatNameEveryPositionLeaveNoError) {
  World world(8, 3, 1);
  for (std::size_t k = 0; k < 8; ++k) {
    for (std::size_t i = 0; i < 3; ++i) world.g[3 * k + i] = static_cast<double>((k >> i) & 1);
  }
  const auto share = world.All({BeliefShape::kUniform, kEverywhere}, ErrorKind::kDistance);
  EXPECT_EQ(share.posterior, 0.0);
  EXPECT_GT(world.Prior({BeliefShape::kUniform, kEverywhere}, {0, 8}), 0.5);
}

// A feature vector that no position is believed to have is never sensed: it has no part in the error, nor in
// the gradients, which stay finite.
TEST(PosteriorError, WhatIsNeverSensedHasNoPartInTheGradient) {
  World world(6, 3, 1);
  for (std::size_t k = 0; k < 6; ++k) {
    for (std::size_t i = 0; i < 3; ++i) world.g[3 * k + i] = static_cast<double>((k >> i) & 1);
  }
  for (const ErrorRule& rule :
       {ErrorRule(ErrorKind::kDistance), ErrorRule(ErrorKind::kPosteriorMass, 0.01)}) {
    const auto share = world.All({BeliefShape::kUniform, kEverywhere}, rule);
    EXPECT_NEAR(share.posterior, 0.0, 1e-12);
    for (std::size_t i = 0; i < share.d_probability.size(); ++i) {
      EXPECT_TRUE(std::isfinite(share.d_probability[i])) << i;
      const bool sensed = i % 8 < 6;  // by one of six positions
      EXPECT_TRUE(sensed || share.d_probability[i] == 0.0) << i;
    }
  }
}

// A map of the very samples that were sensed is what training looks at.
TEST(PosteriorError, InTheMapOfItsOwnSamplesIsTheTrainingsError) {
  const World world(120, 3, 13);
  const auto g = world.G();
  const Pairs pairs(world.positions, world.positions, kBeliefs[2], ErrorKind::kAlong);
  const double error = ErrorInMap(pairs, g, g, 8, world.weight, {0, 120});
  EXPECT_NEAR(error, world.All(kBeliefs[2], ErrorKind::kAlong).posterior, 1e-12);
}

// What the map rules out tells nothing; it must not count as no error.
TEST(PosteriorError, WhatTheMapRulesOutLeavesTheBeliefAsItWas) {
  const World world(30, 1, 17);
  const std::vector<double> never(60, 0.0), always = FeatureProbabilities(std::vector<double>(30, 1.0), 1);
  const Pairs pairs(world.positions, world.positions, kBeliefs[0], ErrorKind::kDistance);
  EXPECT_NEAR(ErrorInMap(pairs, always, never, 2, world.weight, {0, 30}), world.Prior(kBeliefs[0], {0, 30}),
              1e-12);
}

TEST(PosteriorError, FloatsAgreeWithDoubles) {
  const World world(500, 4, 9);
  const auto exact = world.All(kBeliefs[0], ErrorKind::kDistance);
  const std::vector<float> g(world.g.begin(), world.g.end());
  const auto share =
      ErrorOfTruePositions<float>(Pairs(world.positions, world.positions, kBeliefs[0], ErrorKind::kDistance),
                                  FeatureProbabilities(g, 4), 16, world.weight, {0, 500});
  EXPECT_NEAR(share.posterior, exact.posterior, 1e-5 * exact.posterior);
}

}  // namespace
}  // namespace cairn::landmark_learning
