// The entries of a sparse matrix's inverse where the matrix, or its Cholesky factor, has any: without the
// others, which would fill it.
#pragma once

#include <Eigen/SparseCholesky>
#include <vector>

namespace cairn::landmark_map {

using SparseFactor = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;

class SelectedInverse {
 public:
  // By Takahashi's recurrence: K. Takahashi, J. Fagan, M. Chen, Formation of a sparse bus impedance matrix,
  // 1973.
  explicit SelectedInverse(const SparseFactor& factor);

  // Of the matrix that was factorised. Both unknowns must share one of its entries: others read as 0.
  double At(int row, int column) const;

 private:
  const Eigen::SparseMatrix<double> lower_;  // of the permuted matrix: what lies below the diagonal
  std::vector<int> place_;                   // of each unknown in it
  std::vector<double> below_, diagonal_;     // of the inverse: as the factor's entries, and the diagonal
};

}  // namespace cairn::landmark_map
