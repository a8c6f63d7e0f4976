#include "pipelines/local_map/path/pose_graph.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "schema/rng.h"

namespace cairn::local_map {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::infinity();

// Three times round a square of 8 by 8 m, a node a metre, by odometry edges that drift.
struct Laps {
  std::vector<Point> truth, dead;
  std::vector<OdometryEdge> odometry_edges;

  Laps() {
    Rng rng(3);
    truth.push_back({0, 0});
    dead = truth;
    for (int k = 0; k < 96; ++k) {
      const int side = k / 8 % 4;
      const Point offset{side == 0 ? 1.0 : side == 2 ? -1.0 : 0.0, side == 1 ? 1.0 : side == 3 ? -1.0 : 0.0};
      const Point measured{offset.x_m + 0.02 + 0.03 * rng.Normal(), offset.y_m - 0.01 + 0.03 * rng.Normal()};
      truth.push_back({truth.back().x_m + offset.x_m, truth.back().y_m + offset.y_m});
      dead.push_back({dead.back().x_m + measured.x_m, dead.back().y_m + measured.y_m});
      odometry_edges.push_back({k, k + 1, measured, 0.05, 0.05});
    }
  }
  LoopConstraint Loop(int from, int to, double wrong_m = 0) const {
    const Point &a = truth[static_cast<std::size_t>(from)], &b = truth[static_cast<std::size_t>(to)];
    return {from, to, {b.x_m - a.x_m + wrong_m, b.y_m - a.y_m - wrong_m}, 0, 0.05, 0.05, 1};
  }
  double ErrorM(const std::vector<Point>& nodes) const {
    double sum = 0;
    for (std::size_t k = 0; k < nodes.size(); ++k)
      sum += std::hypot(nodes[k].x_m - truth[k].x_m, nodes[k].y_m - truth[k].y_m);
    return sum / static_cast<double>(nodes.size());
  }
};

TEST(OptimizePoseGraph, WithoutConstraintsLeavesOdometry) {
  const Laps laps;
  const OptimizedGraph optimized = OptimizePoseGraph(laps.dead, laps.odometry_edges, {}, {});
  for (std::size_t k = 0; k < laps.dead.size(); ++k) {
    EXPECT_NEAR(optimized.node[k].x_m, laps.dead[k].x_m, 1e-6);
    EXPECT_NEAR(optimized.node[k].y_m, laps.dead[k].y_m, 1e-6);
  }
}

TEST(OptimizePoseGraph, OfTwoOdometryEdgesAndALoopIsTheMeanByVariances) {
  const std::vector<OdometryEdge> odometry_edges{{0, 1, {1, 0}, 0.1, 0.1}, {1, 2, {-1, 0}, 0.1, 0.1}};
  const LoopConstraint loop{0, 2, {0.04, 0}, 0, 0.1, 0.1, 1};
  const OptimizedGraph optimized = OptimizePoseGraph({{0, 0}, {1, 0}, {0, 0}}, odometry_edges, {loop}, {});
  EXPECT_NEAR(optimized.node[2].x_m, 0.04 * 2 / 3,
              1e-6);  // both odometry edges' variances against the loop's
  EXPECT_NEAR(optimized.node[1].x_m, 1 + 0.04 / 3, 1e-6);
  EXPECT_EQ(optimized.weight[0], 1);
}

TEST(OptimizePoseGraph, DropsWrongLoopsAndFollowsTheOthers) {
  const Laps laps;
  std::vector<LoopConstraint> constraints;
  for (int k = 0; k < 64; k += 2) constraints.push_back(laps.Loop(k, k + 32));
  const std::size_t right = constraints.size();
  for (int k = 1; k < 60; k += 6) constraints.push_back(laps.Loop(k, k + 30, 1.5 + 0.02 * k));
  const OptimizedGraph optimized = OptimizePoseGraph(laps.dead, laps.odometry_edges, constraints, {});
  EXPECT_GT(laps.ErrorM(laps.dead), 0.8);
  EXPECT_LT(laps.ErrorM(optimized.node), 0.3);
  for (std::size_t r = 0; r < constraints.size(); ++r) EXPECT_EQ(optimized.weight[r] > 0, r < right) << r;
}

TEST(OptimizePoseGraph, ALoopThatTellsUAloneMovesNothingAlongZ) {
  const std::vector<OdometryEdge> odometry_edges{{0, 1, {1, 0}, 0.1, 0.1}};
  const LoopConstraint loop{0, 1, {0.5, 0.1}, 0, kUnknown, 0.001, 1};
  const OptimizedGraph optimized = OptimizePoseGraph({{0, 0}, {1, 0}}, odometry_edges, {loop}, {});
  EXPECT_NEAR(optimized.node[1].x_m, 1, 1e-6);
  EXPECT_NEAR(optimized.node[1].y_m, 0.1, 1e-3);
}

// A loop constraint is of another place where it lies beyond the gate of 3 standard deviations, along z or
// along u, which lie anyhow; odometry edges hardly give way.
TEST(OptimizePoseGraph, DropsAConstraintThatContradictsAlongEitherAxis) {
  const std::vector<OdometryEdge> odometry_edges{{0, 1, {3, 2}, 1e-3, 1e-3}};
  for (const double axis : {0.0, 0.7, 2.5, -1.2}) {
    const double c = std::cos(axis), s = std::sin(axis);
    const auto weight = [&](double z_m, double u_m) {
      const LoopConstraint constraint{0,   1, {3 + c * z_m - s * u_m, 2 + s * z_m + c * u_m}, axis, 0.05,
                                      0.2, 1};
      return OptimizePoseGraph({{0, 0}, {3, 2}}, odometry_edges, {constraint}, {}).weight[0];
    };
    EXPECT_EQ(weight(0, 0), 1) << axis;
    for (const double sign : {-1.0, 1.0}) {
      EXPECT_EQ(weight(sign * 2.8 * 0.05, 0), 1) << axis;
      EXPECT_EQ(weight(0, sign * 2.8 * 0.2), 1) << axis;
      EXPECT_EQ(weight(sign * 3.2 * 0.05, 0), 0) << axis;
      EXPECT_EQ(weight(0, sign * 3.2 * 0.2), 0) << axis;
      EXPECT_EQ(weight(sign * 2.3 * 0.05, 2.3 * 0.2), 0) << axis;  // 3.25 together
      EXPECT_EQ(weight(sign * 2.0 * 0.05, 2.0 * 0.2), 1) << axis;  // 2.83
    }
  }
}

TEST(OptimizePoseGraph, HoldsTheFirstNodeOfEachPart) {
  const std::vector<OdometryEdge> odometry_edges{{0, 1, {1, 0}, 0.1, 0.1}, {2, 3, {0, 1}, 0.1, 0.1}};
  const OptimizedGraph optimized =
      OptimizePoseGraph({{0, 0}, {1, 0}, {5, 5}, {5, 6}}, odometry_edges, {}, {});
  EXPECT_NEAR(optimized.node[2].x_m, 5, 1e-6);
  EXPECT_NEAR(optimized.node[3].y_m, 6, 1e-6);
  EXPECT_TRUE(OptimizePoseGraph({}, {}, {}, {}).node.empty());
}

}  // namespace
}  // namespace cairn::local_map
