// Covariances of the poses and landmarks that least squares have found.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pipelines/landmark_map/refinement/least_squares.h"

namespace cairn::landmark_map {

// Covariances at the least.
struct LeastSquaresCovariances {
  std::vector<std::vector<Eigen::Matrix3d>> nodes;  // as in the point
  std::vector<Eigen::Matrix2d> landmarks;
  Eigen::MatrixXd joint;  // of all landmarks together, x and y of each [2K,2K]; empty: they are too many
};
inline constexpr std::size_t kMostJoint = 128;  // landmarks
// In the frame in which the landmarks together neither shift nor turn, which is that of whoever lays them
// over the true ones (an S-transformation); where fewer than two were seen, in that of the first pose. Empty:
// no solution.
LeastSquaresCovariances CovariancesOf(const LeastSquaresProblem& problem, const LeastSquaresPoint& point);

}  // namespace cairn::landmark_map
