// The compact representation ([Thr98] section 4.4.2, item 2): P(f | xi) and Bel on grid cells instead of
// samples, so that the sum over pairs costs what the environment is large, not what K is.
//
// With M[c,f] the mean of P(f | s) over the n_c samples in cell c, all taken to be in their middle,
//
//   E = sum_c P(c) sum_f M[c,f] N[c,f] / Z[c,f],   P(c) = sum of P(a) over the samples in c,
//
// over cells as error_sum/posterior_error.h is over samples, and dE/dG[k] = dE/dM[c] / n_c. A belief is
// uniform over the cells that hold samples, however many.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pipelines/landmark_learning/tasks/block_task.h"

namespace cairn::landmark_learning {

struct Cells {
  Positions positions;              // the middles of their samples
  std::vector<double> weight;       // P(c)
  std::vector<std::int32_t> of;     // [samples]: the cell of each
  std::vector<std::int32_t> count;  // of samples

  int size() const { return positions.size(); }
};

// Squares of `cell_m`, those that hold samples, in the order in which the samples come.
Cells CellsOf(const SampleSet& samples, double cell_m);

// A block of cells' share of E, and of dE/dg of all samples: [samples][networks], zero out of its reach.
// `outputs`: g.
template <class Real>
struct CellShare {
  double error = 0.0;
  std::vector<Real> d_output;
};
template <class Real>
CellShare<Real> OutputGradientOfCells(const Options& options, const Cells& cells,
                                      std::span<const Real> outputs, int networks, const IndexRange& block);

}  // namespace cairn::landmark_learning
