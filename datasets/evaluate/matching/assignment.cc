#include "datasets/evaluate/matching/assignment.h"

#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include "schema/error.h"

namespace cairn::datasets {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
using MaybeColumn = std::optional<std::size_t>;

class Assignment {
 public:
  Assignment(const std::vector<std::vector<PairCost>>& costs, std::size_t columns, double unassigned)
      : costs_(costs),
        unassigned_(unassigned),
        row_price_(costs.size()),
        column_price_(columns),
        column_of_(costs.size()),
        row_of_(columns),
        far_(columns, kInfinity),
        passed_(columns),
        came_from_(columns) {}

  std::vector<MaybeColumn> Solve() {
    for (std::size_t row = 0; row < costs_.size(); ++row) AddRow(row);
    return column_of_;
  }

 private:
  using Far = std::pair<double, std::size_t>;  // how far a column is, in reduced costs

  // The shortest path from the row to a column that is free, or to a row that is better left without one.
  void AddRow(std::size_t row) {
    nearest_ = {};
    std::vector<std::size_t> passed;
    least_ = {kInfinity, row};
    Relax(row, 0);
    MaybeColumn free;
    while (!nearest_.empty() && nearest_.top().first < least_.first && !free) {
      const auto [far, column] = nearest_.top();
      nearest_.pop();
      if (passed_[column]) continue;  // on a nearer way
      if (!row_of_[column]) {
        free = column;
        least_.first = far;
      } else {
        passed.push_back(column);
        passed_[column] = true;
        Relax(*row_of_[column], far);
      }
    }
    Reprice(row, passed);
    Shift(row, free);
    for (const std::size_t column : passed) passed_[column] = false;
    for (const std::size_t column : touched_) far_[column] = kInfinity;
    touched_.clear();
  }

  void Relax(std::size_t row, double far_to_it) {
    if (const double without = far_to_it + unassigned_ - row_price_[row]; without < least_.first)
      least_ = {without, row};
    for (const auto& [column, cost] : costs_[row]) {
      const double far = far_to_it + cost - row_price_[row] - column_price_[column];
      if (passed_[column] || far >= far_[column]) continue;  // rounding may make what was passed seem nearer
      far_[column] = far;
      came_from_[column] = row;
      touched_.push_back(column);
      nearest_.emplace(far, column);
    }
  }

  void Reprice(std::size_t row, const std::vector<std::size_t>& passed) {
    row_price_[row] += least_.first;
    for (const std::size_t column : passed) {
      row_price_[*row_of_[column]] += least_.first - far_[column];
      column_price_[column] -= least_.first - far_[column];
    }
  }

  // Each row of the path takes the column that the next one had; the last one the free one, or none.
  void Shift(std::size_t row, MaybeColumn free) {
    std::size_t at = free ? came_from_[*free] : least_.second;
    for (MaybeColumn next = free;;) {
      const MaybeColumn before = std::exchange(column_of_[at], next);
      if (next) row_of_[*next] = at;
      if (at == row) return;
      next = before;
      at = came_from_[*before];
    }
  }

  const std::vector<std::vector<PairCost>>& costs_;
  const double unassigned_;
  std::vector<double> row_price_, column_price_;
  std::vector<MaybeColumn> column_of_, row_of_;
  // Of the row that is being added.
  std::vector<double> far_;
  std::vector<bool> passed_;
  std::vector<std::size_t> came_from_, touched_;
  std::priority_queue<Far, std::vector<Far>, std::greater<>> nearest_;
  std::pair<double, std::size_t>
      least_;  // the shortest way to an end, and the row that is left without there
};

}  // namespace

std::vector<MaybeColumn> AssignOptimally(const std::vector<std::vector<PairCost>>& costs, std::size_t columns,
                                         double unassigned) {
  for (const auto& row : costs)
    for (const PairCost& pair : row) CAIRN_DEMAND(pair.column < columns && pair.cost >= 0, "a pair's cost");
  return Assignment(costs, columns, unassigned).Solve();
}

}  // namespace cairn::datasets
