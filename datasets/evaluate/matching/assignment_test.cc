#include "datasets/evaluate/matching/assignment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "schema/rng.h"

namespace cairn::datasets {
namespace {

double Cost(const std::vector<std::vector<double>>& costs, const std::vector<std::size_t>& column_of) {
  double cost = 0;
  for (std::size_t row = 0; row < costs.size(); ++row) cost += costs[row][column_of[row]];
  return cost;
}

double BestByEnumeration(const std::vector<std::vector<double>>& costs) {
  std::vector<std::size_t> order(costs.front().size());
  std::iota(order.begin(), order.end(), 0U);
  double best = 1e300;
  do {
    best = std::min(best, Cost(costs, order));
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

// Greedy would take the 1 first and pay 1 + 10.
TEST(Assignment, BeatsGreedyByHand) {
  EXPECT_EQ(AssignOptimally({{1, 2}, {2, 10}}), (std::vector<std::size_t>{1, 0}));
}

TEST(Assignment, EqualsEnumerationUpToSevenColumns) {
  Rng rng(1);
  for (std::size_t columns = 1; columns <= 7; ++columns) {
    for (std::size_t rows = 1; rows <= columns; ++rows) {
      for (int trial = 0; trial < 10; ++trial) {
        std::vector<std::vector<double>> costs(rows, std::vector<double>(columns));
        for (auto& row : costs) {
          for (double& cost : row) cost = trial < 5 ? rng.Uniform() : static_cast<double>(rng.Below(4));
        }
        const auto column_of = AssignOptimally(costs);
        EXPECT_EQ(std::set<std::size_t>(column_of.begin(), column_of.end()).size(), rows);
        EXPECT_NEAR(Cost(costs, column_of), BestByEnumeration(costs), 1e-12);
      }
    }
  }
}

TEST(Assignment, OfNothingIsNothing) { EXPECT_TRUE(AssignOptimally({}).empty()); }

TEST(Assignment, FindsAHiddenPermutationOfManyRows) {
  constexpr std::size_t kRows = 150;
  Rng rng(2);
  std::vector<std::size_t> hidden(kRows);
  std::iota(hidden.begin(), hidden.end(), 0U);
  for (std::size_t i = kRows - 1; i > 0; --i) std::swap(hidden[i], hidden[rng.Below(i + 1)]);
  std::vector<std::vector<double>> costs(kRows, std::vector<double>(kRows));
  for (std::size_t row = 0; row < kRows; ++row) {
    for (double& cost : costs[row]) cost = 1 + rng.Uniform();
    costs[row][hidden[row]] = rng.Uniform(0, 0.9);
  }
  EXPECT_EQ(AssignOptimally(costs), hidden);
}

}  // namespace
}  // namespace cairn::datasets
