// The optimal one-to-one assignment, where most pairs do not come into question.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace cairn::datasets {

struct PairCost {
  std::size_t column = 0;
  double cost = 0;  // not negative
};

// `costs`: of each row those columns, of so many, that it may be assigned to. Returns the column of each row,
// all different, or none, with the least total cost, where a row without a column costs `unassigned`.
// Shortest augmenting paths with potentials (H. W. Kuhn 1955, J. Munkres 1957; by Dijkstra's algorithm over
// what is there, R. Jonker and A. Volgenant 1987). The answer is one for all machines.
std::vector<std::optional<std::size_t>> AssignOptimally(const std::vector<std::vector<PairCost>>& costs,
                                                        std::size_t columns, double unassigned);

}  // namespace cairn::datasets
