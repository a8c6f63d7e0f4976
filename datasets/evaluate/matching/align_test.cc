#include "datasets/evaluate/matching/align.h"

#include <gtest/gtest.h>

#include <cmath>

#include "schema/rng.h"

namespace cairn::datasets {
namespace {

const MayMatch kAny = [](std::size_t, std::size_t) { return true; };

std::vector<Point> DrawPoints(Rng& rng, std::size_t count) {
  std::vector<Point> points(count);
  for (Point& point : points) point = {rng.Uniform(0, 80), rng.Uniform(0, 80)};
  return points;
}

// Truth moved away, shuffled, 0.2 m of noise, a quarter missing and as many spurious ones: no associations
// given.
TEST(SearchRigid, FindsTheMotionOfAnIncompleteNoisyMap) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    Rng rng(seed);
    const std::vector<Point> truth = DrawPoints(rng, 20);
    const Similarity away{1, rng.Uniform(-3, 3), 30, -50};
    std::vector<Point> estimate;
    for (std::size_t i = truth.size(); i-- > 5;) {
      const Point at = away(truth[i]);
      estimate.push_back({at.x_m + 0.2 * rng.Normal(), at.y_m + 0.2 * rng.Normal()});
    }
    for (int i = 0; i < 5; ++i) estimate.push_back(away(Point{rng.Uniform(0, 80), rng.Uniform(0, 80)}));
    const Similarity found = SearchRigid(estimate, truth, kAny, {});
    for (const Point& point : truth) EXPECT_LT(DistanceM(found(away(point)), point), 0.5);
  }
}

TEST(SearchRigid, AWrongGuessDoesNotMislead) {
  Rng rng(3);
  const std::vector<Point> truth = DrawPoints(rng, 8);
  const Similarity found = SearchRigid(truth, truth, kAny, {{0, 1}, {1, 0}, {2, 3}});
  for (const Point& point : truth) EXPECT_LT(DistanceM(found(point), point), 1e-9);
}

TEST(SearchRigid, OnePointGivesAShift) {
  const Similarity found = SearchRigid({{1, 1}}, {{5, 2}}, kAny, {});
  EXPECT_NEAR(found.x_m, 4, 1e-12);
  EXPECT_NEAR(found.y_m, 1, 1e-12);
  EXPECT_EQ(found.angle_rad, 0);
}

TEST(SearchRigid, ManyPointsStayWithinTheLimitOfStarts) {
  Rng rng(4);
  const std::vector<Point> truth = DrawPoints(rng, 120);
  const Similarity away{1, 1, 5, 5};
  std::vector<Point> estimate;
  estimate.reserve(truth.size());
  for (const Point& point : truth) estimate.push_back(away(point));
  const Similarity found = SearchRigid(estimate, truth, kAny, {});
  for (const Point& point : truth) EXPECT_LT(DistanceM(found(away(point)), point), 1e-6);
}

}  // namespace
}  // namespace cairn::datasets
