#include "pipelines/landmark_map/refinement/path_matrix.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "pipelines/landmark_map/testing.h"

namespace cairn::landmark_map {
namespace {

// Chains whose poses all meet the last shared unknown, some of them one of the others.
struct Example {
  std::vector<int> chains;
  int shared = 0, poses = 0;
  std::vector<PathMatrix::Coupling> couplings;
  std::vector<std::pair<int, int>> met;  // unknowns
  Eigen::MatrixXd dense;

  explicit Example(std::vector<int> chain_poses, int of_shared = 5)
      : chains(std::move(chain_poses)), shared(of_shared) {
    int first = 0;
    for (const int in_chain : chains) {
      for (int k = 0; k < in_chain; ++k) {
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j) {
            if (j <= i) met.emplace_back(3 * (first + k) + i, 3 * (first + k) + j);
            if (k > 0) met.emplace_back(3 * (first + k) + i, 3 * (first + k - 1) + j);
          }
        couplings.push_back({first + k, shared - 1});
        if (k % 3 == 1) couplings.push_back({first + k, k % (shared - 1)});
      }
      first += in_chain;
    }
    poses = first;
    for (const auto& [pose, with] : couplings)
      for (int i = 0; i < 3; ++i) met.emplace_back(3 * poses + with, 3 * pose + i);
    dense = Eigen::MatrixXd::Zero(3 * poses + shared, 3 * poses + shared);
    Rng rng(7);
    for (int k = 0; k < dense.rows(); ++k) dense(k, k) = 0.01;
    for (const auto& [row, column] : met) {
      const double u = rng.Normal(), v = rng.Normal();
      dense(row, row) += u * u;
      if (row == column) continue;
      dense(column, column) += v * v;
      dense(row, column) += u * v;
      dense(column, row) += u * v;
    }
  }

  void Fill(PathMatrix* matrix) const {
    for (int row = 0; row < dense.rows(); ++row)
      for (int column = 0; column <= row; ++column)
        if (dense(row, column) != 0.0) {
          matrix->Add(row, column, 0.25 * dense(row, column));
          matrix->Add(column, row, 0.75 * dense(row, column));
        }
  }
};

const std::vector<int> kChainsOfAllLengths = {40, 1, 2, 3, 17, 9};

// Whatever the segments: of one pose, of some, of a whole chain.
TEST(PathMatrix, SolvesAsTheWholeMatrixDoes) {
  const Example example(kChainsOfAllLengths);
  const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(example.dense.rows(), -1.0, 2.0);
  for (const int segment_poses : {1, 2, 7, 64}) {
    for (const double damping : {0.0, 0.3}) {
      PathMatrix matrix(example.chains, example.shared, example.couplings, segment_poses);
      example.Fill(&matrix);
      EXPECT_LT((matrix.Diagonal() - example.dense.diagonal()).norm(), 1e-12);
      ASSERT_TRUE(matrix.Factorise(damping));
      Eigen::MatrixXd damped = example.dense;
      damped.diagonal() *= 1.0 + damping;
      const Eigen::VectorXd expected = damped.fullPivLu().solve(right);
      EXPECT_LT((matrix.Solve(right) - expected).norm(), 1e-9 * expected.norm())
          << segment_poses << ' ' << damping;
    }
  }
}

TEST(PathMatrix, HasTheEntriesOfTheWholeInverse) {
  const Example example(kChainsOfAllLengths);
  const Eigen::MatrixXd inverse = example.dense.inverse();
  for (const int segment_poses : {1, 2, 7, 64}) {
    PathMatrix matrix(example.chains, example.shared, example.couplings, segment_poses);
    example.Fill(&matrix);
    ASSERT_TRUE(matrix.Factorise(0.0));
    const PathMatrix::Inverse entries(matrix);
    for (const auto& [row, column] : example.met) {
      const double tolerance = 1e-9 * inverse.cwiseAbs().maxCoeff();
      EXPECT_NEAR(entries.At(row, column), inverse(row, column), tolerance)
          << row << ' ' << column << ' ' << segment_poses;
      EXPECT_NEAR(entries.At(column, row), inverse(row, column), tolerance);
    }
    const int first = 1, count = example.shared - 1;
    EXPECT_LT((entries.OfShared(first, count) - inverse.bottomRightCorner(count, count)).norm(),
              1e-9 * inverse.norm());
  }
}

TEST(PathMatrix, HasTheDeterminantOfTheWholeMatrix) {
  const Example example(kChainsOfAllLengths);
  const double expected = example.dense.fullPivLu().matrixLU().diagonal().cwiseAbs().array().log().sum();
  for (const int segment_poses : {1, 7, 64}) {
    PathMatrix matrix(example.chains, example.shared, example.couplings, segment_poses);
    example.Fill(&matrix);
    ASSERT_TRUE(matrix.Factorise(0.0));
    EXPECT_NEAR(matrix.LogDeterminant(), expected, 1e-9 * std::abs(expected)) << segment_poses;
  }
}

TEST(PathMatrix, IsFilledAnew) {
  const Example example({20, 9});
  PathMatrix matrix(example.chains, example.shared, example.couplings, 4);
  example.Fill(&matrix);
  ASSERT_TRUE(matrix.Factorise(0.0));
  matrix.SetZero();
  for (int k = 0; k < matrix.size(); ++k) matrix.Add(k, k, 2.0);
  ASSERT_TRUE(matrix.Factorise(0.0));
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(matrix.size());
  EXPECT_LT((matrix.Solve(ones) - 0.5 * ones).norm(), 1e-12);
}

// Within a segment, and in the rest.
TEST(PathMatrix, OfAMatrixThatIsNotPositiveDefiniteThereIsNoFactor) {
  const Example example({20, 9});
  for (const int at : {0, 3 * 5 + 1, 3 * 29 + 4}) {
    PathMatrix matrix(example.chains, example.shared, example.couplings, 4);
    example.Fill(&matrix);
    matrix.Add(at, at, -1e3);
    EXPECT_FALSE(matrix.Factorise(0.0)) << at;
  }
}

}  // namespace
}  // namespace cairn::landmark_map
