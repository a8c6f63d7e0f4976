#include "pipelines/landmark_map/refinement/refined_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "pipelines/landmark_map/testing.h"
#include "schema/kinds/log.h"

namespace cairn::landmark_map {
namespace {

Odometry SquareOdometry() {
  return Integrate(Read<kinds::Log>(SquareLog{.laps = 2}.Make()).robot[0].odometry, "rover");
}

// Whatever the cuts, all controls lie in some piece, and each lies in one: within a control, at its end,
// between.
TEST(TrackThrough, ItsPiecesLeadWhereOdometryDoes) {
  const Odometry odometry = SquareOdometry();
  const std::vector<double> times{0.2, 3.0, 3.0, 3.25, 10.0, 10.5, 39.9, 200.0};
  std::vector<int> node_of;
  const NodeTrack track = TrackThrough(odometry, times, &node_of);
  ASSERT_EQ(node_of.size(), times.size());
  EXPECT_EQ(node_of[1], node_of[2]) << "it has not moved";
  const auto nodes = DeadReckoned(track, Eigen::Vector3d::Zero(), {});
  for (std::size_t k = 0; k < times.size(); ++k) {
    const OdometricPose at = PoseAt(odometry, times[k]);
    const Eigen::Vector3d& node = nodes[static_cast<std::size_t>(node_of[k])];
    EXPECT_NEAR(node[0], at.x_m, 1e-9) << k;
    EXPECT_NEAR(node[1], at.y_m, 1e-9) << k;
    EXPECT_NEAR(node[2], at.heading_rad, 1e-9) << k;
  }
  EXPECT_NEAR(nodes.back()[0], odometry.x_m.back(), 1e-9);
}

// A robot that stands for a while, by odometry, and then turns.
TEST(TrackThrough, HasNoNodeWhereTheRobotHasNotMoved) {
  const kinds::Log::Odometry controls{std::vector<double>{1, 2, 3, 4}, std::vector<double>{0, 0, 0, 0.5},
                                      std::vector<double>{1, 0, 0, 0}};
  std::vector<int> node_of;
  const NodeTrack track =
      TrackThrough(Integrate(controls, "rover"), std::vector<double>{1.0, 2.0, 3.0, 3.5}, &node_of);
  EXPECT_EQ(node_of, (std::vector<int>{1, 1, 1, 2}));
  EXPECT_EQ(track.time_s.size(), 3U);
}

TEST(RefinedPath, PassesThroughItsNodesAndBendsBetweenThem) {
  const Odometry odometry = SquareOdometry();
  std::vector<int> node_of;
  const NodeTrack track = TrackThrough(odometry, std::vector<double>{10.0, 20.0, 30.0}, &node_of);
  std::vector<Eigen::Vector3d> nodes = DeadReckoned(track, Eigen::Vector3d::Zero(), {});
  for (std::size_t k = 1; k < nodes.size(); ++k)
    nodes[k] += Eigen::Vector3d(0.3, -0.2, 0.05) * static_cast<double>(k);
  const std::vector<Eigen::Matrix3d> covariances(nodes.size(), 0.01 * Eigen::Matrix3d::Identity());
  const RefinedPath path(odometry, track, nodes, covariances, {}, {0.02, 0.02, 0.02});
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    for (const double by_s : {-1e-9, 0.0, 1e-9}) {
      const RefinedPath::Pose at = path.At(track.time_s[k] + by_s);
      EXPECT_NEAR(at.x_m, nodes[k][0], 5e-3) << k;
      EXPECT_NEAR(at.y_m, nodes[k][1], 5e-3) << k;
    }
  }
  EXPECT_GT(path.At(15.0).covariance(0, 0), path.At(19.99).covariance(0, 0)) << "half-way less is known";
  const RefinedPath::Pose half = path.At(15.0);
  const OdometricPose odometric = PoseAt(odometry, 15.0);
  EXPECT_NEAR(half.heading_rad - odometric.heading_rad, 0.05 * 1.5, 0.01);
}

}  // namespace
}  // namespace cairn::landmark_map
