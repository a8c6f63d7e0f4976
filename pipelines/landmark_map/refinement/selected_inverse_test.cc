#include "pipelines/landmark_map/refinement/selected_inverse.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "pipelines/landmark_map/testing.h"

namespace cairn::landmark_map {
namespace {

// A chain of unknowns of which some also meet one of three that all share: as poses, landmarks and a drift
// do.
TEST(SelectedInverse, HasTheEntriesOfTheWholeInverse) {
  constexpr int kChain = 40, kSize = kChain + 3;
  Rng rng(5);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(kSize, kSize);
  const auto meet = [&](int a, int b) {
    const double u = rng.Normal(), v = rng.Normal();
    dense(a, a) += u * u + 0.01;
    dense(b, b) += v * v + 0.01;
    dense(a, b) += u * v;
    dense(b, a) += u * v;
  };
  for (int k = 1; k < kChain; ++k) meet(k - 1, k);
  for (int k = 0; k < kChain; k += 3) meet(k, kChain + k % 2);
  for (int k = 0; k < kChain; k += 7) meet(k, kChain + 2);
  const Eigen::SparseMatrix<double> matrix = dense.sparseView();
  const SparseFactor factor(matrix);
  ASSERT_EQ(factor.info(), Eigen::Success);
  const SelectedInverse selected(factor);
  const Eigen::MatrixXd inverse = dense.inverse();
  for (int i = 0; i < kSize; ++i) {
    for (int j = 0; j < kSize; ++j) {
      if (dense(i, j) == 0.0) continue;
      EXPECT_NEAR(selected.At(i, j), inverse(i, j), 1e-9 * inverse.cwiseAbs().maxCoeff()) << i << ' ' << j;
    }
  }
}

}  // namespace
}  // namespace cairn::landmark_map
