#include "pipelines/landmark_map/refinement/selected_inverse.h"

#include <algorithm>

namespace cairn::landmark_map {

SelectedInverse::SelectedInverse(const SparseFactor& factor)
    : lower_(factor.matrixL().nestedExpression()),
      below_(static_cast<std::size_t>(lower_.nonZeros()), 0.0),
      diagonal_(static_cast<std::size_t>(lower_.cols()), 0.0) {
  const int size = static_cast<int>(lower_.cols());
  const auto& permutation = factor.permutationP().indices();
  for (int k = 0; k < size; ++k) place_.push_back(permutation.size() > 0 ? permutation[k] : k);
  const int *first = lower_.outerIndexPtr(), *row = lower_.innerIndexPtr();
  const double* value = lower_.valuePtr();
  const Eigen::VectorXd pivots = factor.vectorD();
  // Of column j of the factor, spread out over its rows, and what Z of those rows makes of it.
  Eigen::VectorXd factor_of = Eigen::VectorXd::Zero(size), sum = Eigen::VectorXd::Zero(size);
  for (int j = size - 1; j >= 0; --j) {
    for (int at = first[j]; at < first[j + 1]; ++at) factor_of[row[at]] = value[at];
    for (int at = first[j]; at < first[j + 1]; ++at) {
      const int k = row[at];
      sum[k] += diagonal_[k] * value[at];
      for (int below = first[k]; below < first[k + 1]; ++below) {
        const int i = row[below];
        sum[i] += below_[below] * value[at];
        sum[k] += below_[below] * factor_of[i];
      }
    }
    // Z_ij = -sum_k Z_ik L_kj, Z_jj = 1 / d_j - sum_k L_kj Z_kj; k: the rows of column j below the diagonal
    diagonal_[j] = 1.0 / pivots[j];
    for (int at = first[j]; at < first[j + 1]; ++at) {
      below_[at] = -sum[row[at]];
      diagonal_[j] -= value[at] * below_[at];
    }
    for (int at = first[j]; at < first[j + 1]; ++at) {
      const int k = row[at];
      factor_of[k] = sum[k] = 0.0;
      for (int below = first[k]; below < first[k + 1]; ++below) sum[row[below]] = 0.0;
    }
  }
}

double SelectedInverse::At(int row, int column) const {
  int i = place_[row], j = place_[column];
  if (i == j) return diagonal_[i];
  if (i < j) std::swap(i, j);
  const int* rows = lower_.innerIndexPtr();
  const int *begin = rows + lower_.outerIndexPtr()[j], *end = rows + lower_.outerIndexPtr()[j + 1];
  const int* found = std::lower_bound(begin, end, i);
  return found == end || *found != i ? 0.0 : below_[found - rows];
}

}  // namespace cairn::landmark_map
