#include "pipelines/landmark_map/refinement/broken_motion.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "pipelines/landmark_map/refinement/joint_equations.h"
#include "schema/square.h"

namespace cairn::landmark_map {
namespace {

// A least squares without an observation e of weight W = L L', of which C is the covariance that all leave
// it, is lower by z' (1 - L' C L)^-1 z / 2 with z = L' e. What nothing else tells cannot be missed.
double Gain_nats(const Eigen::Vector3d& error, const Eigen::Matrix3d& weight, const Eigen::Matrix3d& fitted) {
  constexpr double kTold = 1e-7;
  const Eigen::Matrix3d root = weight.llt().matrixL();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> of(Eigen::Matrix3d::Identity() -
                                                          root.transpose() * fitted * root);
  const Eigen::Vector3d along = of.eigenvectors().transpose() * (root.transpose() * error);
  double gain = 0.0;
  for (int k = 0; k < 3; ++k)
    if (of.eigenvalues()[k] > kTold) gain += 0.5 * Square(along[k]) / of.eigenvalues()[k];
  return gain;
}

}  // namespace

std::vector<BrokenMotion> FindBrokenMotions(LeastSquaresProblem problem, const LeastSquaresPoint& start,
                                            std::size_t most) {
  constexpr double kLoose_m = 0.02, kLoose_rad = 0.005;
  problem.loose = {Square(kLoose_m), Square(kLoose_m), Square(kLoose_rad)};
  const LeastSquaresPoint point = Descend(problem, start, 30, kNearTheLeast).point;
  JointEquations equations(problem, point);
  equations.Evaluate(point, true);
  if (!equations.Factorise(0.0)) return {};
  const PathMatrix::Inverse inverse(equations.matrix());
  std::vector<BrokenMotion> motions;
  for (std::size_t r = 0; r < problem.robots.size(); ++r) {
    for (std::size_t k = 0; k < problem.robots[r].controls.size(); ++k) {
      if (problem.robots[r].IsBroken(k)) continue;
      const auto term = equations.Edge(point, r, k);
      motions.push_back(
          {r, k, Gain_nats(term.error, equations.Weight(r, k), Fitted<3, 9>(term.by, term.at, inverse))});
    }
  }
  std::ranges::stable_sort(motions, std::ranges::greater(), &BrokenMotion::gain_nats);
  motions.resize(std::min(motions.size(), most));
  return motions;
}

double NegativeLogDensity(const LeastSquaresProblem& problem, const LeastSquaresPoint& point) {
  JointEquations equations(problem, point);
  double nats = equations.Evaluate(point, false);
  for (std::size_t r = 0; r < problem.robots.size(); ++r)
    for (std::size_t k = 0; k < problem.robots[r].controls.size(); ++k)
      nats -= 0.5 * std::log(equations.Weight(r, k).determinant());
  nats -= LogTailNorm(problem.tail_sigmas) * static_cast<double>(problem.sightings.size());
  for (const Sighting& seen : problem.sightings) {
    const ObservationWidths widths = problem.noise.At(seen.x_m, seen.y_m);
    const Eigen::Vector2d share = equations.ShareOf(seen);
    nats += share[0] * std::log(widths.along_m) + share[1] * std::log(widths.across_m);
  }
  return nats;
}

}  // namespace cairn::landmark_map
