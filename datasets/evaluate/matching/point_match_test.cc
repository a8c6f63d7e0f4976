#include "datasets/evaluate/matching/point_match.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "schema/rng.h"

namespace cairn::datasets {
namespace {

const MayMatch kAnyPoint = [](std::size_t, std::size_t) { return true; };

// Over all one-to-one partial matchings: every order of the estimates against the truth, pairs beyond the
// cut-off dropped.
double GospaByEnumeration(const std::vector<Point>& estimate, const std::vector<Point>& truth) {
  const std::size_t size = std::max(estimate.size(), truth.size());
  std::vector<std::size_t> order(size);
  std::iota(order.begin(), order.end(), 0U);
  double best = 1e300;
  do {
    double squares = 0;
    std::size_t matched = 0;
    for (std::size_t e = 0; e < estimate.size(); ++e) {
      if (order[e] >= truth.size()) continue;
      const double distance = DistanceM(estimate[e], truth[order[e]]);
      if (distance >= kCutOffM) continue;
      squares += distance * distance;
      ++matched;
    }
    const auto unmatched = static_cast<double>(estimate.size() + truth.size() - 2 * matched);
    best = std::min(best, std::sqrt(squares + kCutOffM * kCutOffM / 2 * unmatched));
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

TEST(Gospa, IsKnownForSimpleSets) {
  EXPECT_EQ(MatchPoints({}, {}, kAnyPoint).gospa_m, 0);
  // One missed: sqrt(c^2 / 2). One spurious: the same. Both: c.
  EXPECT_NEAR(MatchPoints({}, {{0, 0}}, kAnyPoint).gospa_m, std::sqrt(4.5), 1e-12);
  EXPECT_NEAR(MatchPoints({{0, 0}}, {}, kAnyPoint).gospa_m, std::sqrt(4.5), 1e-12);
  EXPECT_NEAR(MatchPoints({{0, 0}}, {{100, 0}}, kAnyPoint).gospa_m, 3, 1e-12);
  // Distances 1 and 2, one missed: sqrt(1 + 4 + 4.5).
  const PointMatch match = MatchPoints({{0, 1}, {10, 2}}, {{0, 0}, {10, 0}, {50, 0}}, kAnyPoint);
  EXPECT_NEAR(match.gospa_m, std::sqrt(9.5), 1e-12);
  EXPECT_EQ(match.pairs, (std::vector<std::pair<std::size_t, std::size_t>>{{0, 0}, {1, 1}}));
}

TEST(Gospa, EqualsEnumeration) {
  Rng rng(5);
  for (int trial = 0; trial < 60; ++trial) {
    std::vector<Point> estimate(rng.Below(7)), truth(rng.Below(7));
    for (auto* points : {&estimate, &truth}) {
      for (Point& point : *points) point = {rng.Uniform(0, 8), rng.Uniform(0, 8)};
    }
    EXPECT_NEAR(MatchPoints(estimate, truth, kAnyPoint).gospa_m, GospaByEnumeration(estimate, truth), 1e-12);
  }
}

// A landmark 2.9 m off costs less than one dropped and missed: leaving out bad landmarks does not pay.
TEST(Gospa, DroppingAMatchedPointNeverPays) {
  const std::vector<Point> truth = {{0, 0}, {10, 0}};
  const double with = MatchPoints({{0, 0}, {12.1, 0}}, truth, kAnyPoint).gospa_m;
  const double without = MatchPoints({{0, 0}}, truth, kAnyPoint).gospa_m;
  EXPECT_LT(with * with - without * without, 4.5);
  EXPECT_LT(MatchPoints({{0, 0}, {11.9, 0}}, truth, kAnyPoint).gospa_m, without);
}

// The nearest neighbour of both estimates is the same point; one must take the farther one.
TEST(PointMatch, IsOneToOne) {
  const PointMatch match = MatchPoints({{0, 0}, {0.5, 0}}, {{0.4, 0}, {2.0, 0}}, kAnyPoint);
  EXPECT_EQ(match.pairs, (std::vector<std::pair<std::size_t, std::size_t>>{{0, 0}, {1, 1}}));
}

// A square matrix of costs would take 72 GB.
TEST(PointMatch, OfVeryManyPointsIsFound) {
  constexpr std::size_t kMany = 94'864;  // 308 squared
  std::vector<Point> truth, estimate;
  for (std::size_t k = 0; k < kMany; ++k) {
    truth.push_back({static_cast<double>(k % 308) * 2, static_cast<double>(k / 308) * 2});
    estimate.push_back({truth.back().x_m + 0.5, truth.back().y_m});
  }
  std::ranges::reverse(estimate);
  const PointMatch match = MatchPoints(estimate, truth, kAnyPoint);
  ASSERT_EQ(match.pairs.size(), kMany);
  for (const auto& [e, t] : match.pairs) ASSERT_EQ(e + t, kMany - 1);
  EXPECT_NEAR(match.gospa_m, 0.5 * 308, 1e-9);
}

// Where points lie close together their number counts, not which of them are taken.
TEST(PointMatch, OfManyInOnePlaceIsFound) {
  const std::vector<Point> estimate(3'000, {1, 1}), truth(2'000, {1, 2});
  EXPECT_GE(MatchPoints(estimate, truth, kAnyPoint).pairs.size(), 64U);
}

TEST(PointMatch, TheCutOffItselfDoesNotMatch) {
  EXPECT_TRUE(MatchPoints({{0, 0}}, {{3, 0}}, kAnyPoint).pairs.empty());
  EXPECT_EQ(MatchPoints({{0, 0}}, {{2.999, 0}}, kAnyPoint).pairs.size(), 1U);
}

TEST(PointMatch, KeepsToIdentities) {
  const MayMatch crossed = [](std::size_t e, std::size_t t) { return e != t; };
  const PointMatch match = MatchPoints({{0, 0}, {1, 0}}, {{0, 0}, {1, 0}}, crossed);
  EXPECT_EQ(match.pairs, (std::vector<std::pair<std::size_t, std::size_t>>{{0, 1}, {1, 0}}));
  EXPECT_NEAR(match.gospa_m, std::sqrt(2), 1e-12);
}

}  // namespace
}  // namespace cairn::datasets
