#include "pipelines/local_map/path/assemble.h"

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <cmath>

#include "schema/error.h"

namespace cairn::local_map {
namespace {

constexpr double kHeld_m = 1e-4;  // sd by which the first knots are held

// Normal equations of unknowns x_0, y_0, x_1, ...
class Equations {
 public:
  explicit Equations(std::size_t knots)
      : right_(Eigen::VectorXd::Zero(2 * static_cast<Eigen::Index>(knots))) {}

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

  // One component of (knot `to` - knot `from`), along (c, s).
  void AddDifference(int from, int to, double c, double s, double value, double weight) {
    const Term terms[] = {{2 * to, c}, {2 * to + 1, s}, {2 * from, -c}, {2 * from + 1, -s}};
    Add(terms, 4, value, weight);
  }

  Eigen::VectorXd Solve() const {
    Eigen::SparseMatrix<double> matrix(right_.size(), right_.size());
    matrix.setFromTriplets(entries_.begin(), entries_.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors(matrix);
    CAIRN_DEMAND(factors.info() == Eigen::Success, "every knot hangs on one that is held");
    return factors.solve(right_);
  }

 private:
  std::vector<Eigen::Triplet<double>> entries_;
  Eigen::VectorXd right_;
};

double Square(double x) { return x * x; }

void AddLegs(const std::vector<Leg>& legs, Equations* equations) {
  for (const Leg& leg : legs) {
    const double length = std::hypot(leg.way.x_m, leg.way.y_m);
    const double c = length > 0 ? leg.way.x_m / length : 1, s = length > 0 ? leg.way.y_m / length : 0;
    equations->AddDifference(leg.from, leg.to, c, s, length, 1 / Square(leg.along_m));
    equations->AddDifference(leg.from, leg.to, -s, c, 0, 1 / Square(leg.across_m));
  }
}

void AddRelation(const Relation& relation, double weight, Equations* equations) {
  const double c = std::cos(relation.axis_rad), s = std::sin(relation.axis_rad);
  const double z = c * relation.offset.x_m + s * relation.offset.y_m;
  const double u = -s * relation.offset.x_m + c * relation.offset.y_m;
  if (std::isfinite(relation.sd_z_m))
    equations->AddDifference(relation.from, relation.to, c, s, z, weight / Square(relation.sd_z_m));
  if (std::isfinite(relation.sd_u_m))
    equations->AddDifference(relation.from, relation.to, -s, c, u, weight / Square(relation.sd_u_m));
}

// Squared residual in standard deviations.
double Residual(const Relation& relation, const std::vector<Point>& knot) {
  const Point &from = knot[static_cast<std::size_t>(relation.from)],
              &to = knot[static_cast<std::size_t>(relation.to)];
  const double dx = to.x_m - from.x_m - relation.offset.x_m, dy = to.y_m - from.y_m - relation.offset.y_m;
  const double c = std::cos(relation.axis_rad), s = std::sin(relation.axis_rad);
  return Square((c * dx + s * dy) / relation.sd_z_m) + Square((-s * dx + c * dy) / relation.sd_u_m);
}

// The first knot of each part that legs connect.
std::vector<int> HeldKnots(std::size_t knots, const std::vector<Leg>& legs) {
  std::vector<char> reached(knots, 0);
  for (const Leg& leg : legs) reached[static_cast<std::size_t>(leg.to)] = 1;
  std::vector<int> held;
  for (std::size_t k = 0; k < knots; ++k)
    if (!reached[k]) held.push_back(static_cast<int>(k));
  return held;
}

}  // namespace

Assembly Assemble(const std::vector<Point>& start, const std::vector<Leg>& legs,
                  const std::vector<Relation>& relations, const AssemblyOptions& options) {
  const std::vector<int> held = HeldKnots(start.size(), legs);
  Assembly assembly{start, std::vector<double>(relations.size(), 1.0)};
  if (start.empty()) return assembly;
  const auto solve = [&] {
    Equations equations(start.size());
    for (const int k : held) {
      const Point& at = start[static_cast<std::size_t>(k)];
      const Equations::Term x{2 * k, 1}, y{2 * k + 1, 1};
      equations.Add(&x, 1, at.x_m, 1 / Square(kHeld_m));
      equations.Add(&y, 1, at.y_m, 1 / Square(kHeld_m));
    }
    AddLegs(legs, &equations);
    for (std::size_t r = 0; r < relations.size(); ++r)
      if (assembly.weight[r] > 0)
        AddRelation(relations[r], assembly.weight[r] * relations[r].quality, &equations);
    const Eigen::VectorXd solved = equations.Solve();
    for (std::size_t k = 0; k < start.size(); ++k) {
      const auto at = static_cast<Eigen::Index>(2 * k);
      assembly.knot[k] = {solved[at], solved[at + 1]};
    }
  };
  // The first answer follows odometry alone; relations come in by what they differ from it.
  std::ranges::fill(assembly.weight, 0.0);
  solve();
  if (relations.empty()) return assembly;
  double widest = 0;
  for (const Relation& relation : relations) widest = std::max(widest, Residual(relation, assembly.knot));
  const double bound = Square(options.gate);
  double mu = std::max(1.0, 2 * widest / bound);  // from a loss that is all but convex
  constexpr double kNarrower = 1.4;
  for (int round = 0; round < options.rounds; ++round) {
    for (std::size_t r = 0; r < relations.size(); ++r)
      assembly.weight[r] = Square(mu * bound / (Residual(relations[r], assembly.knot) + mu * bound));
    solve();
    if (mu == 1) break;
    mu = std::max(1.0, mu / kNarrower);
  }
  for (std::size_t r = 0; r < relations.size(); ++r)
    assembly.weight[r] = Residual(relations[r], assembly.knot) > bound ? 0.0 : 1.0;
  solve();
  return assembly;
}

}  // namespace cairn::local_map
