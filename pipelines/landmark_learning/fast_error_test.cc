#include "pipelines/landmark_learning/fast_error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipelines/landmark_learning/features.h"
#include "pipelines/landmark_learning/line_sums.h"
#include "schema/rng.h"

namespace cairn::landmark_learning {
namespace {

constexpr double kEverywhere = std::numeric_limits<double>::infinity();

// Samples along a line in any order, some of them at one place.
struct Line {
  Places places;
  std::vector<double> probability, weight;
  int vectors;

  Line(int samples, int networks, std::uint64_t seed) : vectors(1 << networks) {
    Rng rng(seed);
    std::vector<double> g;
    for (int k = 0; k < samples; ++k) {
      places.x_m.push_back(k % 7 == 3 ? places.x_m.back() : rng.Uniform(0.0, 30.0));
      places.y_m.push_back(0.0);
      places.along_m.push_back(rng.Uniform(0.0, 50.0));
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
  for (const double reach : {0.4, 3.0, 11.0, kEverywhere}) {
    for (const ErrorKind error : {ErrorKind::kDistance, ErrorKind::kSquaredDistance, ErrorKind::kAlong}) {
      if (error == ErrorKind::kAlong && std::isfinite(reach)) continue;
      for (const int networks : {1, 3, 5}) {
        const Line line(230, networks, 3);
        const Belief belief{BeliefShape::kUniform, reach};
        for (const Range& truths : {Range{0, 230}, Range{20, 101}}) {
          const auto slow = ErrorOfTruths(Pairs(line.places, line.places, belief, error), line.probability,
                                          line.vectors, line.weight, truths);
          const auto fast =
              ErrorOnLine(line.places, belief, error, line.probability, line.vectors, line.weight, truths);
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
  for (double& y : plane.places.y_m) y = rng.Uniform(-20.0, 20.0);
  const Belief belief{BeliefShape::kUniform, kEverywhere};
  const auto slow = ErrorOfTruths(Pairs(plane.places, plane.places, belief, ErrorKind::kSquaredDistance),
                                  plane.probability, plane.vectors, plane.weight, {0, 150});
  ExpectSame(ErrorOnLine(plane.places, belief, ErrorKind::kSquaredDistance, plane.probability, plane.vectors,
                         plane.weight, {0, 150}),
             slow, 1e-11);
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
