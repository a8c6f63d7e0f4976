// The optimal one-to-one assignment.
#pragma once

#include <cstddef>
#include <vector>

namespace cairn::datasets {

// `costs`: [rows][columns], finite, rows <= columns. Returns the column of each row, all different, with the
// least total cost. The Hungarian method with potentials (H. W. Kuhn 1955, J. Munkres 1957), rows^2 * columns
// steps. Ties go to the smaller column, so the answer is one for all machines.
std::vector<std::size_t> AssignOptimally(const std::vector<std::vector<double>>& costs);

}  // namespace cairn::datasets
