#include "pipelines/landmark_map/refinement/joint_covariances.h"

#include <Eigen/LU>

#include "pipelines/landmark_map/refinement/joint_equations.h"

namespace cairn::landmark_map {
namespace {

// As of one landmark, below. `moved`: what a small rigid motion does to each [2K,3].
Eigen::MatrixXd JointOf(const PathMatrix::Inverse& inverse, const UnknownLayout& layout,
                        const Eigen::MatrixXd& with_motion, const Eigen::Matrix3d& of_motion,
                        const Eigen::MatrixXd& moved) {
  if (moved.rows() == 0) return {};
  const auto size = static_cast<int>(moved.rows());
  const Eigen::MatrixXd with = with_motion.middleRows(layout.Landmark(0), size) * moved.transpose();
  Eigen::MatrixXd joint =
      inverse.OfShared(0, size) - with - with.transpose() + moved * of_motion * moved.transpose();
  return 0.5 * (joint + joint.transpose());
}

}  // namespace

// With d the rigid motion that lays the landmarks, moved by small amounts, over where they were, d = A dl: a
// pose in the landmarks' frame is p - G d, G what a rigid motion does to it. Its covariance takes the columns
// Cov(., A dl) alone. What a landmark's sightings err by in common is no unknown, but is considered: how far
// it would shift all (S. Schmidt, Application of state-space methods to navigation problems, 1966).
LeastSquaresCovariances CovariancesOf(const LeastSquaresProblem& problem, const LeastSquaresPoint& point) {
  JointEquations equations(problem, point);
  equations.Evaluate(point, true);
  if (!equations.Factorise(0.0)) return {};
  const UnknownLayout& layout = equations.layout();
  const PathMatrix::Inverse inverse(equations.matrix());
  std::vector<bool> is_seen(point.landmarks.size(), false);
  for (const Sighting& seen : problem.sightings) is_seen[static_cast<std::size_t>(seen.landmark)] = true;

  const auto moved_by = [](double x, double y) {  // what a small rigid motion does to a place
    Eigen::Matrix<double, 2, 3> motion;
    motion << 1.0, 0.0, -y, 0.0, 1.0, x;
    return motion;
  };
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(layout.size(), 3);  // A'
  int seen_landmarks = 0;
  for (std::size_t l = 0; l < point.landmarks.size(); ++l) {
    if (!is_seen[l]) continue;
    ++seen_landmarks;
    const auto motion = moved_by(point.landmarks[l].x(), point.landmarks[l].y());
    squares += motion.transpose() * motion;
    columns.middleRows<2>(layout.Landmark(l)) = motion;
  }
  if (seen_landmarks >= 2) {
    const Eigen::Matrix3d inverse_squares = squares.inverse();
    for (int k = 0; k < layout.size(); ++k) columns.row(k) = (columns.row(k) * inverse_squares).eval();
  } else {
    columns.setZero();
  }
  Eigen::MatrixXd with_motion(layout.size(), 3);  // Cov(., d)
  for (int k = 0; k < 3; ++k) with_motion.col(k) = equations.matrix().Solve(columns.col(k));
  Eigen::Matrix3d of_motion = Eigen::Matrix3d::Zero();
  for (int k = 0; k < layout.size(); ++k) of_motion += columns.row(k).transpose() * with_motion.row(k);

  const auto transformed = [&]<int kSize>(int at, const Eigen::Matrix<double, kSize, 3>& motion) {
    Eigen::Matrix<double, kSize, kSize> own;
    for (int i = 0; i < kSize; ++i) {
      for (int j = 0; j < kSize; ++j) own(i, j) = inverse.At(at + i, at + j);
    }
    const Eigen::Matrix<double, kSize, 3> with = with_motion.middleRows<kSize>(at);
    own += motion * of_motion * motion.transpose() - with * motion.transpose() - motion * with.transpose();
    return Eigen::Matrix<double, kSize, kSize>(0.5 * (own + own.transpose()));
  };
  const auto moved_node = [&](std::size_t r, std::size_t k) {
    Eigen::Matrix3d motion = Eigen::Matrix3d::Zero();
    motion.topRows<2>() = moved_by(point.nodes[r][k][0], point.nodes[r][k][1]);
    motion(2, 2) = 1.0;
    return motion;
  };
  const auto moved_landmark = [&](std::size_t l) {
    return moved_by(point.landmarks[l].x(), point.landmarks[l].y());
  };
  LeastSquaresCovariances covariances;
  for (std::size_t r = 0; r < point.nodes.size(); ++r) {
    auto& of_robot = covariances.nodes.emplace_back();
    for (std::size_t k = 0; k < point.nodes[r].size(); ++k)
      of_robot.push_back(transformed.template operator()<3>(layout.Node(r, k), moved_node(r, k)));
  }
  Eigen::MatrixXd all_moved(2 * point.landmarks.size(), 3);
  for (std::size_t l = 0; l < point.landmarks.size(); ++l) {
    covariances.landmarks.push_back(
        transformed.template operator()<2>(layout.Landmark(l), moved_landmark(l)));
    all_moved.middleRows<2>(2 * static_cast<Eigen::Index>(l)) = moved_landmark(l);
  }
  if (point.landmarks.size() <= kMostJoint)
    covariances.joint = JointOf(inverse, layout, with_motion, of_motion, all_moved);

  for (const Eigen::VectorXd& bias : equations.CommonErrors(point)) {
    const Eigen::VectorXd shift = equations.matrix().Solve(bias);
    const Eigen::Vector3d of_landmarks = columns.transpose() * shift;
    for (std::size_t r = 0; r < point.nodes.size(); ++r) {
      for (std::size_t k = 0; k < point.nodes[r].size(); ++k) {
        const Eigen::Vector3d off = shift.segment<3>(layout.Node(r, k)) - moved_node(r, k) * of_landmarks;
        covariances.nodes[r][k] += off * off.transpose();
      }
    }
    for (std::size_t l = 0; l < point.landmarks.size(); ++l) {
      const Eigen::Vector2d off = shift.segment<2>(layout.Landmark(l)) - moved_landmark(l) * of_landmarks;
      covariances.landmarks[l] += off * off.transpose();
    }
    if (covariances.joint.size() == 0) continue;
    const Eigen::VectorXd off =
        shift.segment(layout.Landmark(0), all_moved.rows()) - all_moved * of_landmarks;
    covariances.joint += off * off.transpose();
  }
  return covariances;
}

}  // namespace cairn::landmark_map
