#include "pipelines/evidence_map/log_odds.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cairn::evidence_map {
namespace {

// [Thr01] eq. 1 as it is printed, reading by reading.
TEST(LogOdds, EqualsTheRecursionOfEquationOne) {
  const double prior = 0.3, p_occupied = 0.7, p_free = 0.2;
  const std::vector<double> readings{p_free, p_occupied, p_free, p_occupied, p_occupied};
  double l = std::log(prior / (1 - prior));
  for (const double p : readings) l = std::log(p / (1 - p)) + std::log((1 - prior) / prior) + l;
  const Totals totals{{2}, {3}};
  EXPECT_NEAR(LogOddsOf({{&totals, {p_occupied, p_free}, 1}}, 1, prior, 100)[0], l, 1e-12);
}

TEST(LogOdds, OfSensorsAreAddedAndCellsThatNoneToldOfAreNoNumbers) {
  const Totals rays{{0, 0}, {1, 0}}, cones{{512, 0}, {0, 0}};
  const auto l = LogOddsOf({{&rays, {0.7, 0.4}, 1}, {&cones, {0.6, 0.45}, 256}}, 2, 0.5, 100);
  EXPECT_NEAR(l[0], LogOdds(0.7) + 2 * LogOdds(0.45), 1e-12);
  EXPECT_TRUE(std::isnan(l[1]));
}

TEST(LogOdds, ReadingsThatCancelAreNotThoseThatWereNeverMade) {
  const Totals totals{{1}, {1}};
  EXPECT_EQ(LogOddsOf({{&totals, {0.7, 0.3}, 1}}, 1, 0.5, 100)[0], LogOdds(0.7) + LogOdds(0.3));
}

TEST(LogOdds, AreCutToTheClamp) {
  const Totals totals{{0, 900}, {900, 0}};
  const auto l = LogOddsOf({{&totals, {0.7, 0.4}, 1}}, 2, 0.5, 5);
  EXPECT_EQ(l[0], 5);
  EXPECT_EQ(l[1], -5);
  EXPECT_NEAR(Probability(5), 0.99331, 1e-5);
  EXPECT_NEAR(LogOdds(Probability(-3.7)), -3.7, 1e-12);
}

}  // namespace
}  // namespace cairn::evidence_map
