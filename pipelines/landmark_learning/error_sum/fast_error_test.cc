#include "pipelines/landmark_learning/error_sum/fast_error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipelines/landmark_learning/error_sum/features.h"
#include "pipelines/landmark_learning/error_sum/line_sums.h"
#include "pipelines/landmark_learning/error_sum/tree_sums.h"
#include "schema/rng.h"

namespace cairn::landmark_learning {
namespace {

constexpr double kWholeGrid = std::numeric_limits<double>::infinity();

// Samples along a line in any order, some of them at one position.
struct Line {
  Positions positions;
  std::vector<double> probability, weight;
  int vectors;

  Line(int samples, int networks, std::uint64_t seed) : vectors(1 << networks) {
    Rng rng(seed);
    std::vector<double> g;
    for (int k = 0; k < samples; ++k) {
      positions.x_m.push_back(k % 7 == 3 ? positions.x_m.back() : rng.Uniform(0.0, 30.0));
      positions.y_m.push_back(0.0);
      positions.along_m.push_back(rng.Uniform(0.0, 50.0));
      weight.push_back(rng.Uniform(0.5, 1.5) / samples);
      for (int i = 0; i < networks; ++i) g.push_back(std::pow(rng.Uniform(), 4));
    }
    probability = FeatureProbabilities(g, networks);
  }
};

void ExpectSame(const ErrorShare<double>& fast, const ErrorShare<double>& slow, double tolerance) {
  EXPECT_NEAR(fast.posterior, slow.posterior, tolerance * slow.posterior);
  ASSERT_EQ(fast.d_probability.size(), slow.d_probability.size());
  double largest = 0.0;
  for (const double slope : slow.d_probability) largest = std::max(largest, std::abs(slope));
  ASSERT_GT(largest, 0.0);
  for (std::size_t i = 0; i < slow.d_probability.size(); ++i)
    EXPECT_NEAR(fast.d_probability[i], slow.d_probability[i], tolerance * largest) << i;
}

// The pair kernel in double is itself held to the literal sum over triples (PosteriorError).
TEST(ErrorOnLine, EqualsTheSumOverPairsForEveryErrorWindowAndBlock) {
  for (const double reach : {0.4, 3.0, 11.0, kWholeGrid}) {
    for (const ErrorKind error : {ErrorKind::kDistance, ErrorKind::kSquaredDistance, ErrorKind::kAlong}) {
      if (error == ErrorKind::kAlong && std::isfinite(reach)) continue;
      for (const int networks : {1, 3, 5}) {
        const Line line(230, networks, 3);
        const Belief belief{BeliefShape::kUniform, reach};
        for (const IndexRange& true_positions : {IndexRange{0, 230}, IndexRange{20, 101}}) {
          const auto slow = ErrorOfTruePositions(Pairs(line.positions, line.positions, belief, error),
                                                 line.probability, line.vectors, line.weight, true_positions);
          const auto fast = ErrorOnLine(line.positions, belief, error, line.probability, line.vectors,
                                        line.weight, true_positions);
          ExpectSame(fast, slow, 1e-11);
        }
      }
    }
  }
}

// The square of a distance is the sum of two, along x and along y: no line is needed.
TEST(ErrorOnLine, SquaredDistancesInThePlaneAreExactWhereNothingIsKnown) {
  Line plane(150, 2, 5);
  Rng rng(9);
  for (double& y : plane.positions.y_m) y = rng.Uniform(-20.0, 20.0);
  const Belief belief{BeliefShape::kUniform, kWholeGrid};
  const auto slow =
      ErrorOfTruePositions(Pairs(plane.positions, plane.positions, belief, ErrorKind::kSquaredDistance),
                           plane.probability, plane.vectors, plane.weight, {0, 150});
  ExpectSame(ErrorOnLine(plane.positions, belief, ErrorKind::kSquaredDistance, plane.probability,
                         plane.vectors, plane.weight, {0, 150}),
             slow, 1e-11);
}

// Positions scattered, in two clusters far apart, along a route, all at one point but one.
std::vector<Positions> Plane(int count) {
  std::vector<Positions> all(4);
  Rng rng(21);
  for (int k = 0; k < count; ++k) {
    const auto add = [](Positions* positions, double x_m, double y_m) {
      positions->x_m.push_back(x_m);
      positions->y_m.push_back(y_m);
      positions->along_m.push_back(0.0);
    };
    add(&all[0], rng.Uniform(-50.0, 70.0), rng.Uniform(1000.0, 1090.0));
    add(&all[1], (k % 2) * 5000.0 + rng.Normal(), (k % 2) * 3000.0 + rng.Normal());
    add(&all[2], 0.05 * k + 0.1 * rng.Normal(), 20.0 * std::sin(0.01 * k));
    add(&all[3], k == 5 ? 40.0 : 3.0, 3.0);
  }
  return all;
}

TEST(ErrorInPlane, IsWithinItsBoundOfTheSumOverPairs) {
  constexpr int kCount = 1500;
  Rng rng(4);
  for (const Positions& positions : Plane(kCount)) {
    for (const int networks : {1, 3}) {
      std::vector<double> g, weight(kCount, 1.0 / kCount);
      for (int i = 0; i < networks * kCount; ++i) g.push_back(std::pow(rng.Uniform(), 3));
      const auto probability = FeatureProbabilities(g, networks);
      const Pairs pairs(positions, positions, {BeliefShape::kUniform, kWholeGrid}, ErrorKind::kDistance);
      for (const IndexRange& true_positions : {IndexRange{0, kCount}, IndexRange{100, 340}}) {
        const auto slow = ErrorOfTruePositions(pairs, probability, 1 << networks, weight, true_positions);
        const auto fast = ErrorInPlane(positions, probability, 1 << networks, weight, true_positions);
        ExpectSame(fast, slow, kFarBound);
        EXPECT_GT(slow.posterior, 0.0);
      }
    }
  }
}

// Not that of E by pairs, which is close, but that of what is minimised.
TEST(ErrorInPlane, TheGradientIsExactlyThatOfItsOwnError) {
  constexpr int kCount = 900, kNetworks = 2;
  const Positions positions = Plane(kCount)[0];
  Rng rng(6);
  std::vector<double> g, weight(kCount, 1.0 / kCount);
  for (int i = 0; i < kNetworks * kCount; ++i) g.push_back(rng.Uniform());
  const auto share = [&] {
    return ErrorInPlane(positions, FeatureProbabilities(g, kNetworks), 1 << kNetworks, weight, {0, kCount});
  };
  const auto gradient = OutputGradient(g, kNetworks, share().d_probability);
  double largest = 0.0;
  for (const double slope : gradient) largest = std::max(largest, std::abs(slope));
  ASSERT_GT(largest, 0.0);
  for (std::size_t i = 0; i < g.size(); i += 211) {
    const double at = g[i];
    const auto error_at = [&](double step) {
      g[i] = at + step;
      const double error = share().posterior;
      g[i] = at;
      return error;
    };
    constexpr double kStep = 3e-3;
    const double slope =
        (8.0 * (error_at(kStep) - error_at(-kStep)) - (error_at(2 * kStep) - error_at(-2 * kStep))) /
        (12.0 * kStep);
    EXPECT_NEAR(gradient[i], slope, 1e-6 * std::max(std::abs(gradient[i]), 1e-3 * largest)) << i;
  }
}

// Each product, not only what they add up to.
TEST(TreeSums, KeepTheirBoundForEachPositionAndFeature) {
  constexpr std::size_t kCount = 1200, kWidth = 8;
  const Positions positions = Plane(kCount)[0];
  Rng rng(8);
  std::vector<double> h, weighted(kCount * kWidth, 0.0);
  for (std::size_t i = 0; i < kCount * kWidth; ++i) h.push_back(rng.Uniform() < 0.01 ? 1.0 : 0.0);
  TreeSums<double> tree(positions);
  EXPECT_GT(tree.FarPairs(), 1000.0);
  EXPECT_LT(tree.NearPairs(), 0.5 * kCount * kCount);
  tree.Add(h.data(), kWidth, weighted.data());
  for (std::size_t a = 0; a < kCount; ++a) {
    for (std::size_t f = 0; f < kWidth; ++f) {
      double expected = 0.0;
      for (std::size_t k = 0; k < kCount; ++k)
        expected += std::hypot(positions.x_m[a] - positions.x_m[k], positions.y_m[a] - positions.y_m[k]) *
                    h[kWidth * k + f];
      EXPECT_NEAR(weighted[kWidth * a + f], expected, kFarBound * expected);
    }
  }
}

// Features of ten thousand kilometres away must not drown those near by: nothing cancels.
TEST(LineSums, KeepTheirBoundFarFromTheOrigin) {
  std::vector<double> t, h;
  Rng rng(2);
  for (int k = 0; k < 400; ++k) {
    t.push_back((k < 200 ? 0.0 : 1e7) + 0.125 * k);
    for (int f = 0; f < kLineFeatures; ++f) h.push_back(rng.Uniform());
  }
  const double reach = 2.0;
  constexpr auto kWidth = static_cast<std::size_t>(kLineFeatures);
  const LineSums sums(t, reach, false);
  std::vector<double> weighted(h.size(), 0.0), believed(h.size(), 0.0);
  sums.Add(h.data(), weighted.data(), believed.data());
  EXPECT_LT(sums.Bound(), 1e-14);
  for (std::size_t a = 0; a < t.size(); ++a) {
    for (std::size_t f = 0; f < kWidth; ++f) {
      long double expected = 0.0L, all = 0.0L;
      for (std::size_t k = 0; k < t.size(); ++k) {
        const double distance = std::abs(t[a] - t[k]);
        if (distance > reach) continue;
        expected += static_cast<long double>(distance) * h[kWidth * k + f];
        all += h[kWidth * k + f];
      }
      const auto near = static_cast<double>(expected), here = static_cast<double>(all);
      EXPECT_NEAR(weighted[kWidth * a + f], near, sums.Bound() * near) << a;
      EXPECT_NEAR(believed[kWidth * a + f], here, sums.Bound() * here) << a;
    }
  }
}

}  // namespace
}  // namespace cairn::landmark_learning
