#include "pipelines/local_map/path/pose_graph.h"

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <cmath>

#include "schema/error.h"
#include "schema/square.h"

namespace cairn::local_map {
namespace {

constexpr double kHeld_m = 1e-4;  // sd by which the first nodes are held

// Normal equations of unknowns x_0, y_0, x_1, ...
class Equations {
 public:
  explicit Equations(std::size_t nodes)
      : right_(Eigen::VectorXd::Zero(2 * static_cast<Eigen::Index>(nodes))) {}

  // (a . unknowns - value)^2 weight
  struct Term {
    int unknown;
    double by;
  };
  void Add(const Term* terms, int count, double value, double weight) {
    for (int i = 0; i < count; ++i) {
      for (int j = 0; j < count; ++j)
        entries_.emplace_back(terms[i].unknown, terms[j].unknown, weight * terms[i].by * terms[j].by);
      right_[terms[i].unknown] += weight * terms[i].by * value;
    }
  }

  // One component of (node `to` - node `from`), along (c, s).
  void AddDifference(int from, int to, double c, double s, double value, double weight) {
    const Term terms[] = {{2 * to, c}, {2 * to + 1, s}, {2 * from, -c}, {2 * from + 1, -s}};
    Add(terms, 4, value, weight);
  }

  Eigen::VectorXd Solve() const {
    Eigen::SparseMatrix<double> matrix(right_.size(), right_.size());
    matrix.setFromTriplets(entries_.begin(), entries_.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors(matrix);
    CAIRN_DEMAND(factors.info() == Eigen::Success, "every node hangs on one that is held");
    return factors.solve(right_);
  }

 private:
  std::vector<Eigen::Triplet<double>> entries_;
  Eigen::VectorXd right_;
};

void AddOdometryEdges(const std::vector<OdometryEdge>& odometry_edges, Equations* equations) {
  for (const OdometryEdge& odometry_edge : odometry_edges) {
    const double length = std::hypot(odometry_edge.offset.x_m, odometry_edge.offset.y_m);
    const double c = length > 0 ? odometry_edge.offset.x_m / length : 1,
                 s = length > 0 ? odometry_edge.offset.y_m / length : 0;
    equations->AddDifference(odometry_edge.from, odometry_edge.to, c, s, length,
                             1 / Square(odometry_edge.along_m));
    equations->AddDifference(odometry_edge.from, odometry_edge.to, -s, c, 0,
                             1 / Square(odometry_edge.across_m));
  }
}

void AddLoopConstraint(const LoopConstraint& constraint, double weight, Equations* equations) {
  const double c = std::cos(constraint.axis_rad), s = std::sin(constraint.axis_rad);
  const double z = c * constraint.offset.x_m + s * constraint.offset.y_m;
  const double u = -s * constraint.offset.x_m + c * constraint.offset.y_m;
  if (std::isfinite(constraint.sd_z_m))
    equations->AddDifference(constraint.from, constraint.to, c, s, z, weight / Square(constraint.sd_z_m));
  if (std::isfinite(constraint.sd_u_m))
    equations->AddDifference(constraint.from, constraint.to, -s, c, u, weight / Square(constraint.sd_u_m));
}

// Squared residual in standard deviations.
double Residual(const LoopConstraint& constraint, const std::vector<Point>& node) {
  const Point &from = node[static_cast<std::size_t>(constraint.from)],
              &to = node[static_cast<std::size_t>(constraint.to)];
  const double dx = to.x_m - from.x_m - constraint.offset.x_m, dy = to.y_m - from.y_m - constraint.offset.y_m;
  const double c = std::cos(constraint.axis_rad), s = std::sin(constraint.axis_rad);
  return Square((c * dx + s * dy) / constraint.sd_z_m) + Square((-s * dx + c * dy) / constraint.sd_u_m);
}

// The first node of each part that odometry edges connect.
std::vector<int> HeldNodes(std::size_t nodes, const std::vector<OdometryEdge>& odometry_edges) {
  std::vector<char> reached(nodes, 0);
  for (const OdometryEdge& odometry_edge : odometry_edges)
    reached[static_cast<std::size_t>(odometry_edge.to)] = 1;
  std::vector<int> held;
  for (std::size_t k = 0; k < nodes; ++k)
    if (!reached[k]) held.push_back(static_cast<int>(k));
  return held;
}

}  // namespace

OptimizedGraph OptimizePoseGraph(const std::vector<Point>& start,
                                 const std::vector<OdometryEdge>& odometry_edges,
                                 const std::vector<LoopConstraint>& constraints,
                                 const PoseGraphOptions& options) {
  const std::vector<int> held = HeldNodes(start.size(), odometry_edges);
  OptimizedGraph optimized{start, std::vector<double>(constraints.size(), 1.0)};
  if (start.empty()) return optimized;
  // [DM98] section 4.3 seeks no global frame; a batch puts one path together from the loop constraints
  // between traces.
  const auto solve = [&] {
    Equations equations(start.size());
    for (const int k : held) {
      const Point& at = start[static_cast<std::size_t>(k)];
      const Equations::Term x{2 * k, 1}, y{2 * k + 1, 1};
      equations.Add(&x, 1, at.x_m, 1 / Square(kHeld_m));
      equations.Add(&y, 1, at.y_m, 1 / Square(kHeld_m));
    }
    AddOdometryEdges(odometry_edges, &equations);
    for (std::size_t r = 0; r < constraints.size(); ++r)
      if (optimized.weight[r] > 0)
        AddLoopConstraint(constraints[r], optimized.weight[r] * constraints[r].quality, &equations);
    const Eigen::VectorXd solved = equations.Solve();
    for (std::size_t k = 0; k < start.size(); ++k) {
      const auto at = static_cast<Eigen::Index>(2 * k);
      optimized.node[k] = {solved[at], solved[at + 1]};
    }
  };
  // The first answer follows odometry alone; loop constraints come in by what they differ from it.
  std::ranges::fill(optimized.weight, 0.0);
  solve();
  if (constraints.empty()) return optimized;
  double widest = 0;
  for (const LoopConstraint& constraint : constraints)
    widest = std::max(widest, Residual(constraint, optimized.node));
  const double bound = Square(options.gate);
  double mu = std::max(1.0, 2 * widest / bound);  // from a loss that is all but convex
  constexpr double kNarrower = 1.4;
  for (int round = 0; round < options.rounds; ++round) {
    for (std::size_t r = 0; r < constraints.size(); ++r)
      optimized.weight[r] = Square(mu * bound / (Residual(constraints[r], optimized.node) + mu * bound));
    solve();
    if (mu == 1) break;
    mu = std::max(1.0, mu / kNarrower);
  }
  for (std::size_t r = 0; r < constraints.size(); ++r)
    optimized.weight[r] = Residual(constraints[r], optimized.node) > bound ? 0.0 : 1.0;
  solve();
  return optimized;
}

}  // namespace cairn::local_map
