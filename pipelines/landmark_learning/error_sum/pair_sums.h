// The products with e and Bel_prior that E_posterior and its gradient are made of, for a strip of true
// positions: a kernel that keeps its sums in registers.
#pragma once

#include <vector>

#include "pipelines/landmark_learning/error_sum/feature_rows.h"
#include "pipelines/landmark_learning/error_sum/pairs.h"
#include "pipelines/landmark_learning/error_sum/register_blocks.h"

namespace cairn::landmark_learning {

inline constexpr int kStripTruePositions = 24;

// Its tables are used again for the next strip: fresh ones would cost more than what is computed with them.
template <class Real>
class Strip {
 public:
  explicit Strip(const Pairs& pairs) : pairs_(pairs) {}

  // Makes e and Bel_prior of at most kStripTruePositions true positions and all samples in their reach. What
  // the tables hold for true positions that a strip lacks is of no meaning.
  void Take(const IndexRange& true_positions);

  // n[a] = sum_k e[a,k] B[a,k] G[k] and z[a] = sum_k B[a,k] G[k], each [kStripTruePositions][width].
  void Gather(const FeatureRows<Real>& g, Real* n, Real* z) const;

  // The transpose: d[k] += sum_a (e[a,k] B[a,k] r[a] + B[a,k] s[a]), r and s each
  // [kStripTruePositions][width], zero for true positions that the strip lacks.
  void Scatter(const Real* r, const Real* s, int width, GradientRows<Real>* d) const;

 private:
  struct At {
    Stretch stretch;
    int column;  // of the tables
  };
  // Of a table, the columns of samples first <= k < end.
  SmallMatrix<Real> Part(const std::vector<Real>& table, const At& at, int first, int end) const;

  const Pairs& pairs_;
  std::vector<Stretch> reached_;
  std::vector<At> stretches_;
  int stride_ = 0;
  Columns<Real> columns_;
  std::vector<Real> belief_, weighted_;  // [kStripTruePositions][stride]
};

extern template class Strip<float>;
extern template class Strip<double>;

}  // namespace cairn::landmark_learning
