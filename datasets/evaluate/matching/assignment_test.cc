#include "datasets/evaluate/matching/assignment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "schema/rng.h"

namespace cairn::datasets {
namespace {

// All columns come into question for each row, and none is left without.
std::vector<std::size_t> AssignAll(const std::vector<std::vector<double>>& costs) {
  std::vector<std::vector<PairCost>> pairs(costs.size());
  for (std::size_t row = 0; row < costs.size(); ++row)
    for (std::size_t column = 0; column < costs[row].size(); ++column)
      pairs[row].push_back({column, costs[row][column]});
  std::vector<std::size_t> column_of;
  for (const auto& column : AssignOptimally(pairs, costs.empty() ? 0 : costs.front().size(), 1e6))
    column_of.push_back(column.value());
  return column_of;
}

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
  EXPECT_EQ(AssignAll({{1, 2}, {2, 10}}), (std::vector<std::size_t>{1, 0}));
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
        const auto column_of = AssignAll(costs);
        EXPECT_EQ(std::set<std::size_t>(column_of.begin(), column_of.end()).size(), rows);
        EXPECT_NEAR(Cost(costs, column_of), BestByEnumeration(costs), 1e-12);
      }
    }
  }
}

// Rows may be left without a column, and of most pairs nothing is said: against all ways to do it.
TEST(Assignment, OfAFewPairsItEqualsEnumeration) {
  Rng rng(3);
  for (int trial = 0; trial < 300; ++trial) {
    const std::size_t rows = 1 + rng.Below(6), columns = 1 + rng.Below(6);
    const double unassigned = trial % 2 == 0 ? 1 : 2;
    std::vector<std::vector<PairCost>> pairs(rows);
    // A column for each row, or, past the columns, none.
    std::vector<std::vector<double>> whole(rows, std::vector<double>(columns + rows, unassigned));
    for (std::size_t row = 0; row < rows; ++row) {
      for (std::size_t column = 0; column < columns; ++column) {
        whole[row][column] = 1e3;
        if (rng.Below(2) == 0) continue;
        whole[row][column] = trial % 3 == 0 ? static_cast<double>(rng.Below(3)) : rng.Uniform(0, 2);
        pairs[row].push_back({column, whole[row][column]});
      }
    }
    const auto found = AssignOptimally(pairs, columns, unassigned);
    std::vector<std::size_t> column_of;
    std::set<std::size_t> used;
    for (std::size_t row = 0; row < rows; ++row) {
      column_of.push_back(found[row].value_or(columns + row));
      used.insert(column_of.back());
    }
    EXPECT_EQ(used.size(), rows);
    EXPECT_NEAR(Cost(whole, column_of), Cost(whole, AssignAll(whole)), 1e-12) << trial;
    if (columns + rows <= 8) {
      EXPECT_NEAR(Cost(whole, column_of), BestByEnumeration(whole), 1e-12) << trial;
    }
  }
}

TEST(Assignment, OfNothingIsNothing) { EXPECT_TRUE(AssignAll({}).empty()); }

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
  EXPECT_EQ(AssignAll(costs), hidden);
}

}  // namespace
}  // namespace cairn::datasets
