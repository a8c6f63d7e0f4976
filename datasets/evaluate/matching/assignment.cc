#include "datasets/evaluate/matching/assignment.h"

#include <limits>

#include "schema/error.h"

namespace cairn::datasets {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Column `columns_` is a place outside the matrix, where each new row starts its search.
class Hungarian {
 public:
  explicit Hungarian(const std::vector<std::vector<double>>& costs)
      : costs_(costs),
        columns_(costs.empty() ? 0 : costs.front().size()),
        row_price_(costs.size(), 0.0),
        column_price_(columns_ + 1, 0.0),
        row_of_(columns_ + 1, kNone) {}

  std::vector<std::size_t> Solve() {
    for (std::size_t row = 0; row < costs_.size(); ++row) AddRow(row);
    std::vector<std::size_t> column_of(costs_.size());
    for (std::size_t column = 0; column < columns_; ++column) {
      if (row_of_[column] != kNone) column_of[row_of_[column]] = column;
    }
    return column_of;
  }

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  // Shortest augmenting path from `row` to a free column, in reduced costs (Dijkstra).
  void AddRow(std::size_t row) {
    std::vector<double> slack(columns_, kInfinity);
    std::vector<std::size_t> came_from(columns_, columns_);
    std::vector<bool> reached(columns_ + 1, false);
    row_of_[columns_] = row;
    std::size_t at = columns_;
    while (row_of_[at] != kNone) {
      reached[at] = true;
      Relax(at, reached, slack, came_from);
      const std::size_t next = Nearest(reached, slack);
      Reprice(slack[next], reached, slack);
      at = next;
    }
    while (at != columns_) {
      row_of_[at] = row_of_[came_from[at]];
      at = came_from[at];
    }
  }

  void Relax(std::size_t at, const std::vector<bool>& reached, std::vector<double>& slack,
             std::vector<std::size_t>& came_from) const {
    const std::size_t row = row_of_[at];
    for (std::size_t column = 0; column < columns_; ++column) {
      const double reduced = costs_[row][column] - row_price_[row] - column_price_[column];
      if (!reached[column] && reduced < slack[column]) {
        slack[column] = reduced;
        came_from[column] = at;
      }
    }
  }

  std::size_t Nearest(const std::vector<bool>& reached, const std::vector<double>& slack) const {
    std::size_t nearest = kNone;
    for (std::size_t column = 0; column < columns_; ++column) {
      if (!reached[column] && (nearest == kNone || slack[column] < slack[nearest])) nearest = column;
    }
    CAIRN_DEMAND(nearest != kNone, "an assignment needs at least as many columns as rows");
    return nearest;
  }

  void Reprice(double step, const std::vector<bool>& reached, std::vector<double>& slack) {
    for (std::size_t column = 0; column <= columns_; ++column) {
      if (reached[column]) {
        row_price_[row_of_[column]] += step;
        column_price_[column] -= step;
      } else if (column < columns_) {
        slack[column] -= step;
      }
    }
  }

  const std::vector<std::vector<double>>& costs_;
  std::size_t columns_;
  std::vector<double> row_price_;
  std::vector<double> column_price_;
  std::vector<std::size_t> row_of_;
};

}  // namespace

std::vector<std::size_t> AssignOptimally(const std::vector<std::vector<double>>& costs) {
  for (const auto& row : costs) {
    CAIRN_DEMAND(row.size() == costs.front().size() && costs.size() <= row.size(),
                 "rows <= columns, all equal");
  }
  return Hungarian(costs).Solve();
}

}  // namespace cairn::datasets
