// The normal equations of a least-squares problem about a point: residuals, their derivatives, their matrix.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "pipelines/landmark_map/refinement/least_squares.h"
#include "pipelines/landmark_map/refinement/path_matrix.h"

namespace cairn::landmark_map {

// Unknowns of a robot that are the same all along: its odometry's three, and its ranges'.
inline constexpr int kSystematic = 4;

// Where each unknown stands in the vector of all: the nodes of each robot, the landmarks, each robot's
// systematic errors.
class UnknownLayout {
 public:
  explicit UnknownLayout(const LeastSquaresProblem& problem);
  int Node(std::size_t robot, std::size_t node) const { return first_[robot] + 3 * static_cast<int>(node); }
  int Landmark(std::size_t landmark) const { return landmarks_ + 2 * static_cast<int>(landmark); }
  int Errors(std::size_t robot) const { return errors_ + kSystematic * static_cast<int>(robot); }
  int size() const { return size_; }

  PathMatrix Matrix(const LeastSquaresProblem& problem) const;
  LeastSquaresPoint Moved(LeastSquaresPoint point, const Eigen::VectorXd& step) const;

 private:
  std::vector<int> first_;
  int landmarks_ = 0, errors_ = 0, size_ = 0;
};

// A sighting's errors along its ray and across it, in standard deviations, and their derivatives by node,
// landmark and the offset of its ranges.
struct SightingResidual {
  Eigen::Vector2d error;
  Eigen::Matrix<double, 2, 3> by_node;
  Eigen::Matrix2d by_landmark;
  Eigen::Vector2d by_offset;  // of its ranges
};

// The problem with the edges' covariances, which hardly depend on the point. Keeps a reference to it.
class JointEquations {
 public:
  JointEquations(const LeastSquaresProblem& problem, const LeastSquaresPoint& at);

  const UnknownLayout& layout() const { return layout_; }
  const Eigen::VectorXd& gradient() const { return gradient_; }
  const PathMatrix& matrix() const { return matrix_; }
  const Eigen::VectorXd& diagonal() const { return diagonal_; }

  // Minus the logarithm of the probability, and with `linearise` its matrix and gradient, in which sightings
  // count `sighting_share`.
  double Evaluate(const LeastSquaresPoint& point, bool linearise, double sighting_share = 1.0);

  // Of the matrix as it was made last, its diagonal raised by a share of itself. False: it has no factor.
  bool Factorise(double damping) { return matrix_.Factorise(damping); }

  // What of a sighting along its ray and across is its own.
  Eigen::Vector2d ShareOf(const Sighting& seen) const;
  // Of each landmark whose sightings have errors that go on: how the gradient would change if all of them
  // erred by a standard deviation of what they have in common, along their rays or across.
  std::vector<Eigen::VectorXd> CommonErrors(const LeastSquaresPoint& point) const;
  // A Cauchy's: what a sighting counts less than a Gaussian's.
  double Weight(const SightingResidual& residual, const Sighting& seen) const;

  const EdgeSpread& Spread(std::size_t robot, std::size_t edge) const { return spreads_[robot][edge]; }
  const Eigen::Matrix3d& Weight(std::size_t robot, std::size_t edge) const { return weights_[robot][edge]; }

  // Jacobian of an edge's error by its nine unknowns, and where they stand.
  struct EdgeTerm {
    Eigen::Vector3d error;
    Eigen::Matrix<double, 3, 9> by;
    std::array<int, 9> at;
  };
  EdgeTerm Edge(const LeastSquaresPoint& point, std::size_t r, std::size_t k) const;

  struct SightingTerm {
    SightingResidual residual;
    Eigen::Matrix<double, 2, 6> by;
    std::array<int, 6> at;
  };
  SightingTerm Seen(const LeastSquaresPoint& point, const Sighting& seen) const;

 private:
  template <int kErrors, int kUnknowns>
  void AddTerm(const Eigen::Matrix<double, kErrors, 1>& error,
               const Eigen::Matrix<double, kErrors, kUnknowns>& by, const std::array<int, kUnknowns>& at,
               const Eigen::Matrix<double, kErrors, kErrors>& weight);
  void AddAnchor(const LeastSquaresPoint& point, bool linearise);
  void AddPriors(const LeastSquaresPoint& point, std::size_t r, bool linearise);
  void AddEdge(const LeastSquaresPoint& point, std::size_t r, std::size_t k, bool linearise);
  void AddSighting(const LeastSquaresPoint& point, const Sighting& seen, bool linearise);

  const LeastSquaresProblem& problem_;
  UnknownLayout layout_;
  Eigen::Vector3d anchor_;
  PathMatrix matrix_;
  std::vector<std::vector<EdgeSpread>> spreads_;       // of each robot's edges
  std::vector<std::vector<Eigen::Matrix3d>> weights_;  // inverse covariances
  double cost_ = 0.0, sighting_share_ = 1.0;
  Eigen::VectorXd gradient_, diagonal_;
};

// J Cov J' of a term, of the unknowns' selected covariances.
template <int kErrors, int kUnknowns>
Eigen::Matrix<double, kErrors, kErrors> Fitted(const Eigen::Matrix<double, kErrors, kUnknowns>& by,
                                               const std::array<int, kUnknowns>& at,
                                               const PathMatrix::Inverse& inverse) {
  Eigen::Matrix<double, kUnknowns, kUnknowns> covariance;
  for (int i = 0; i < kUnknowns; ++i) {
    for (int j = 0; j <= i; ++j) covariance(i, j) = covariance(j, i) = inverse.At(at[i], at[j]);
  }
  return by * covariance * by.transpose();
}

}  // namespace cairn::landmark_map
