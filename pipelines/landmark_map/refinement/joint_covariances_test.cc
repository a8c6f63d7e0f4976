#include "pipelines/landmark_map/refinement/joint_covariances.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <array>
#include <cmath>

#include "pipelines/landmark_map/refinement/testing.h"

namespace cairn::landmark_map {
namespace {

// Squares of the errors of the landmarks and of one pose in units of their covariances, in the frame of the
// found landmarks: the true ones are laid over them.
struct Squares {
  double landmarks = 0.0, pose = 0.0;  // a landmark's in the mean
  double together = 0.0;               // of all landmarks, by their joint covariance
};
Squares SquaresOf(const EightWorld& world, const LeastSquaresPoint& found,
                  const LeastSquaresCovariances& covariances) {
  Eigen::Vector2d mean_true = Eigen::Vector2d::Zero(), mean_found = mean_true;
  for (std::size_t l = 0; l < 6; ++l) {
    mean_true += world.truth.landmarks[l] / 6.0;
    mean_found += found.landmarks[l] / 6.0;
  }
  double dot = 0.0, cross = 0.0;
  for (std::size_t l = 0; l < 6; ++l) {
    const Eigen::Vector2d a = world.truth.landmarks[l] - mean_true, b = found.landmarks[l] - mean_found;
    dot += a.dot(b);
    cross += a.x() * b.y() - a.y() * b.x();
  }
  const double turn = std::atan2(cross, dot), c = std::cos(turn), s = std::sin(turn);
  const auto laid = [&](const Eigen::Vector2d& p) -> Eigen::Vector2d {
    const Eigen::Vector2d a = p - mean_true;
    return mean_found + Eigen::Vector2d(c * a.x() - s * a.y(), s * a.x() + c * a.y());
  };
  Squares squares;
  Eigen::VectorXd all(12);
  for (std::size_t l = 0; l < 6; ++l) {
    const Eigen::Vector2d off = laid(world.truth.landmarks[l]) - found.landmarks[l];
    all.segment<2>(2 * static_cast<Eigen::Index>(l)) = off;
    squares.landmarks += off.dot(covariances.landmarks[l].inverse() * off) / 6.0;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(covariances.joint);
  for (int k = 3; k < 12; ++k)  // in the first three they do not move
    squares.together += std::pow(axes.eigenvectors().col(k).dot(all), 2) / axes.eigenvalues()[k];
  const std::size_t node = 60;
  Eigen::Vector3d off;
  off << laid(world.truth.nodes[0][node].head<2>()) - found.nodes[0][node].head<2>(),
      world.truth.nodes[0][node][2] + turn - found.nodes[0][node][2];
  squares.pose = off.dot(covariances.nodes[0][node].inverse() * off);
  return squares;
}

// Over many worlds as large as their covariances say: two a landmark, three a pose, nine of six landmarks
// together.
TEST(CovariancesOf, AreThoseOfTheErrorsInTheLandmarksFrame) {
  constexpr int kWorlds = 60;
  Squares mean;
  for (int k = 0; k < kWorlds; ++k) {
    const EightWorld world(100 + static_cast<std::uint64_t>(k), 0.3 * kDegree, 1.02, 120);
    const LeastSquaresPoint found = Descend(world.problem, world.truth).point;
    const LeastSquaresCovariances covariances = CovariancesOf(world.problem, found);
    ASSERT_EQ(covariances.landmarks.size(), 6U);
    const Squares squares = SquaresOf(world, found, covariances);
    mean.landmarks += squares.landmarks / kWorlds;
    mean.pose += squares.pose / kWorlds;
    mean.together += squares.together / kWorlds;
    const Eigen::VectorXd smallest =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(covariances.joint).eigenvalues();
    EXPECT_LT(smallest[2], 1e-9 * smallest[11]) << "together they neither shift nor turn";
    EXPECT_GT(smallest[3], 1e-6 * smallest[11]);
    for (Eigen::Index l = 0; l < 6; ++l)
      EXPECT_LT(
          (covariances.joint.block<2, 2>(2 * l, 2 * l) - covariances.landmarks[static_cast<std::size_t>(l)])
              .norm(),
          1e-9 * smallest[11]);
  }
  EXPECT_NEAR(mean.together, 9.0, 1.8);  // a Cauchy's weights make errors of a Gaussian count for less
  EXPECT_NEAR(mean.landmarks, 2.0, 0.35);
  EXPECT_NEAR(mean.pose, 3.0, 1.0);
}

// A landmark is seen too near or too far by as much each time. Were each sighting's error its own, the
// landmarks would be off by far more than the covariances say.
TEST(CovariancesOf, CountWhatALandmarksSightingsErrByInCommon) {
  constexpr int kWorlds = 40;
  double considered = 0.0, each_its_own = 0.0;
  for (int k = 0; k < kWorlds; ++k) {
    EightWorld world(300 + static_cast<std::uint64_t>(k), 0.3 * kDegree, 1.02, 360);
    Rng rng(static_cast<std::uint64_t>(k));
    std::array<double, 6> common{};
    for (double& error : common) error = 0.1 * std::sqrt(0.8) * rng.Normal();
    for (Sighting& seen : world.problem.sightings) {
      const Eigen::Vector2d way = world.truth.landmarks[static_cast<std::size_t>(seen.landmark)] -
                                  world.truth.nodes[0][static_cast<std::size_t>(seen.node)].head<2>();
      const double range =
          way.norm() + common[static_cast<std::size_t>(seen.landmark)] + 0.1 * std::sqrt(0.2) * rng.Normal();
      const double bearing = std::atan2(seen.y_m, seen.x_m);
      seen.x_m = range * std::cos(bearing);
      seen.y_m = range * std::sin(bearing);
    }
    LeastSquaresPoint found = Descend(world.problem, world.truth).point;
    each_its_own += SquaresOf(world, found, CovariancesOf(world.problem, found)).landmarks / kWorlds;
    world.problem.repeats = {9.0, 1.0};  // of a correlation of 0.8
    found = Descend(world.problem, found).point;
    considered += SquaresOf(world, found, CovariancesOf(world.problem, found)).landmarks / kWorlds;
  }
  EXPECT_GT(each_its_own, 5.0);
  EXPECT_NEAR(considered, 1.8, 0.6);
}

}  // namespace
}  // namespace cairn::landmark_map
