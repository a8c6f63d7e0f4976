// Over 500 lines: residuals, their derivatives and the normal equations are one class that nobody else should
// see, and the descent, the widths and the covariances are each read off it.
#include "pipelines/landmark_map/refinement/least_squares.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "pipelines/landmark_map/refinement/path_matrix.h"

namespace cairn::landmark_map {
namespace {

constexpr double kAnchor_m = 1e-2;  // standard deviation that holds the first pose: nothing else pulls at it
constexpr double kLeastDistance_m = 0.01;  // nearer than that there is no bearing
constexpr double kUnheld = 1e5;            // of an unknown that no residual is of
constexpr double kLeastDecrease = 1e-3;    // nats that a step must promise

// What the mean of a sighting's weighted square is of a Gaussian's: E[s / (1 + s / 9)] / 2, s a chi square of
// two.
constexpr double kMeanWeightedSquare = 0.7205;
// No motion's square counts more: a robot that was carried does not tell how wide odometry's errors are.
constexpr double kMostSquareOfMotion = 9.0;

double SquareOfIt(double x) { return x * x; }

// What of a sighting's curvature holds the motions, where their residuals are compared with what is expected
// of them: with a the mean of the score's derivative (0.7205), b that of its square (0.5372), A the motions'
// matrix and H the sightings', a residual's covariance lacks M^-1 (A + (2 a - b) H) M^-1 with M = A + a H,
// which is (A + b H)^-1 to first order; in the equations H counts 0.8399, its mean weight.
constexpr double kHoldingShare = 0.5372 / 0.8399;

// Where each unknown stands in the vector of all.
class UnknownLayout {
 public:
  explicit UnknownLayout(const LeastSquaresProblem& problem) {
    for (const NodeTrack& track : problem.robots) {
      first_.push_back(size_);
      size_ += 3 * static_cast<int>(track.time_s.size());
    }
    landmarks_ = size_;
    errors_ = size_ + 2 * problem.landmarks;
    size_ = errors_ + 3 * static_cast<int>(problem.robots.size());
  }
  int Node(std::size_t robot, std::size_t node) const { return first_[robot] + 3 * static_cast<int>(node); }
  int Landmark(std::size_t landmark) const { return landmarks_ + 2 * static_cast<int>(landmark); }
  int Errors(std::size_t robot) const { return errors_ + 3 * static_cast<int>(robot); }
  int size() const { return size_; }

  PathMatrix Matrix(const LeastSquaresProblem& problem) const {
    std::vector<int> chains;
    std::vector<PathMatrix::Coupling> couplings;
    for (std::size_t r = 0; r < problem.robots.size(); ++r) {
      const int nodes = static_cast<int>(problem.robots[r].time_s.size());
      chains.push_back(nodes);
      for (int k = 0; k < nodes; ++k)
        for (int i = 0; i < 3; ++i) couplings.push_back({first_[r] / 3 + k, Errors(r) + i - landmarks_});
    }
    for (const Sighting& seen : problem.sightings)
      for (int i = 0; i < 2; ++i)
        couplings.push_back(
            {first_[static_cast<std::size_t>(seen.robot)] / 3 + seen.node, 2 * seen.landmark + i});
    return {chains, size_ - landmarks_, couplings};
  }

  LeastSquaresPoint Moved(LeastSquaresPoint point, const Eigen::VectorXd& step) const {
    for (std::size_t r = 0; r < point.nodes.size(); ++r) {
      for (std::size_t k = 0; k < point.nodes[r].size(); ++k)
        point.nodes[r][k] += step.segment<3>(Node(r, k));
      const int at = Errors(r);
      point.errors[r].drift_rad_per_m += step[at];
      point.errors[r].way += step[at + 1];
      point.errors[r].turn += step[at + 2];
    }
    for (std::size_t l = 0; l < point.landmarks.size(); ++l)
      point.landmarks[l] += step.segment<2>(Landmark(l));
    return point;
  }

 private:
  std::vector<int> first_;
  int landmarks_ = 0, errors_ = 0, size_ = 0;
};

// The end of an edge less where its controls lead, in the frame of its beginning, and its derivatives by both
// nodes.
struct EdgeResidual {
  Eigen::Vector3d error;
  Eigen::Matrix3d by_begin, by_end;
};
EdgeResidual ResidualOf(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& motion) {
  const double cosine = std::cos(a[2]), sine = std::sin(a[2]);
  const double dx = b[0] - a[0], dy = b[1] - a[1];
  const double x = cosine * dx + sine * dy, y = cosine * dy - sine * dx;
  EdgeResidual residual;
  residual.error << x - motion[0], y - motion[1], b[2] - a[2] - motion[2];
  residual.by_end << cosine, sine, 0.0, -sine, cosine, 0.0, 0.0, 0.0, 1.0;
  residual.by_begin = -residual.by_end;
  residual.by_begin(0, 2) = y;
  residual.by_begin(1, 2) = -x;
  return residual;
}

// A sighting's errors along its ray and across it, in standard deviations, and their derivatives by node and
// landmark.
struct SightingResidual {
  Eigen::Vector2d error;
  Eigen::Matrix<double, 2, 3> by_node;
  Eigen::Matrix2d by_landmark;
};
SightingResidual ResidualOf(const Eigen::Vector3d& node, const Eigen::Vector2d& landmark,
                            const Sighting& seen, const ObservationNoise& noise) {
  const double cosine = std::cos(node[2]), sine = std::sin(node[2]);
  Eigen::Matrix2d back;
  back << cosine, sine, -sine, cosine;
  const Eigen::Vector2d there = back * (landmark - node.head<2>());
  const ObservationWidths widths = noise.At(seen.x_m, seen.y_m);
  SightingResidual residual;
  Eigen::Matrix2d by_there = Eigen::Matrix2d::Identity();
  if (seen.contact()) {
    residual.error = there;
  } else {
    // The bearing itself: measured across, in metres, a smaller map would have smaller errors.
    const double range = std::hypot(seen.x_m, seen.y_m), distance = std::max(kLeastDistance_m, there.norm());
    const double turn =
        std::atan2(seen.x_m * there.y() - seen.y_m * there.x(), seen.x_m * there.x() + seen.y_m * there.y());
    residual.error << there.norm() - range, range * turn;
    by_there << there.x(), there.y(), -range * there.y() / distance, range * there.x() / distance;
    by_there /= distance;
  }
  residual.error = residual.error.cwiseQuotient(Eigen::Vector2d(widths.along_m, widths.across_m));
  by_there.row(0) /= widths.along_m;
  by_there.row(1) /= widths.across_m;
  residual.by_landmark = by_there * back;
  residual.by_node.leftCols<2>() = -residual.by_landmark;
  residual.by_node.col(2) = by_there * Eigen::Vector2d(there.y(), -there.x());
  return residual;
}

// A value under a Cauchy prior: its cost [nats], gradient and curvature (that of a Gaussian of the same
// gradient).
struct PriorTerm {
  double cost, gradient, curvature;
};
PriorTerm CauchyPrior(double value, double scale) {
  const double square = SquareOfIt(value / scale), curvature = 2.0 / (SquareOfIt(scale) * (1.0 + square));
  return {std::log1p(square), curvature * value, curvature};
}

// The problem with the edges' covariances, which hardly depend on the point.
class NormalEquationsOf {
 public:
  NormalEquationsOf(const LeastSquaresProblem& problem, const LeastSquaresPoint& at)
      : problem_(problem), layout_(problem), anchor_(at.nodes[0][0]), matrix_(layout_.Matrix(problem)) {
    for (std::size_t r = 0; r < problem.robots.size(); ++r) {
      auto& spreads = spreads_.emplace_back();
      auto& weights = weights_.emplace_back();
      for (const std::vector<Control>& controls : problem.robots[r].controls) {
        spreads.push_back(SpreadOf(controls, at.errors[r]));
        weights.push_back(CovarianceOf(spreads.back(), problem.widths[r]).inverse());
      }
    }
  }

  const UnknownLayout& layout() const { return layout_; }
  const Eigen::VectorXd& gradient() const { return gradient_; }
  const PathMatrix& matrix() const { return matrix_; }
  const Eigen::VectorXd& diagonal() const { return diagonal_; }

  // Minus the logarithm of the probability, and with `linearise` its matrix and gradient, in which sightings
  // count `sighting_share`.
  double Evaluate(const LeastSquaresPoint& point, bool linearise, double sighting_share = 1.0) {
    cost_ = 0.0;
    sighting_share_ = sighting_share;
    if (linearise) {
      matrix_.SetZero();
      gradient_ = Eigen::VectorXd::Zero(layout_.size());
      for (int k = 0; k < layout_.size(); ++k) matrix_.Add(k, k, 1.0 / SquareOfIt(kUnheld));
    }
    AddAnchor(point, linearise);
    for (std::size_t r = 0; r < problem_.robots.size(); ++r) {
      AddPriors(point, r, linearise);
      for (std::size_t k = 0; k < problem_.robots[r].controls.size(); ++k) AddEdge(point, r, k, linearise);
    }
    for (const Sighting& seen : problem_.sightings) AddSighting(point, seen, linearise);
    if (linearise) diagonal_ = matrix_.Diagonal();
    return cost_;
  }

  // Of the matrix as it was made last, its diagonal raised by a share of itself. False: it has no factor.
  bool Factorise(double damping) { return matrix_.Factorise(damping); }

  // What of a sighting along its ray and across is its own.
  Eigen::Vector2d ShareOf(const Sighting& seen) const {
    if (seen.contact()) return {1.0, 1.0};
    return {1.0 / problem_.repeats.along, 1.0 / problem_.repeats.across};
  }
  // Of each landmark whose sightings have errors that go on: how the gradient would change if all of them
  // erred by a standard deviation of what they have in common, along their rays or across.
  std::vector<Eigen::VectorXd> CommonErrors(const LeastSquaresPoint& point) const {
    const SightingRepeats& repeats = problem_.repeats;
    const Eigen::Vector2d correlation((repeats.along - 1.0) / (repeats.along + 1.0),
                                      (repeats.across - 1.0) / (repeats.across + 1.0));
    std::vector<Eigen::VectorXd> errors;
    for (int k = 0; k < 2; ++k) {
      if (!(correlation[k] > 0.0)) continue;
      const std::size_t first = errors.size();
      errors.resize(first + point.landmarks.size(), Eigen::VectorXd::Zero(layout_.size()));
      for (const Sighting& seen : problem_.sightings) {
        if (seen.contact()) continue;
        const SightingTerm term = Seen(point, seen);
        const double pull = std::sqrt(correlation[k]) * Weight(term.residual, seen) * ShareOf(seen)[k];
        Eigen::VectorXd& error = errors[first + static_cast<std::size_t>(seen.landmark)];
        for (int i = 0; i < 5; ++i) error[term.at[i]] += pull * term.by(k, i);
      }
    }
    return errors;
  }
  // A Cauchy's: what a sighting counts less than a Gaussian's.
  double Weight(const SightingResidual& residual, const Sighting& seen) const {
    return 1.0 / (1.0 + residual.error.cwiseAbs2().dot(ShareOf(seen)) / SquareOfIt(kCauchySigmas));
  }

  const EdgeSpread& Spread(std::size_t robot, std::size_t edge) const { return spreads_[robot][edge]; }
  const Eigen::Matrix3d& Weight(std::size_t robot, std::size_t edge) const { return weights_[robot][edge]; }

  // Jacobian of an edge's error by its nine unknowns, and where they stand.
  struct EdgeTerm {
    Eigen::Vector3d error;
    Eigen::Matrix<double, 3, 9> by;
    std::array<int, 9> at;
  };
  EdgeTerm Edge(const LeastSquaresPoint& point, std::size_t r, std::size_t k) const {
    const MotionEdge edge = Integral(problem_.robots[r].controls[k], point.errors[r]);
    const EdgeResidual residual = ResidualOf(point.nodes[r][k], point.nodes[r][k + 1], edge.motion);
    // In odometry's own units, in which it errs: in the map's a smaller map would have smaller errors.
    const double of_way = 1.0 / (1.0 + point.errors[r].way);
    const Eigen::Vector3d units(of_way, of_way, 1.0);
    EdgeTerm term;
    term.error = units.cwiseProduct(residual.error);
    term.by << residual.by_begin, residual.by_end, -edge.derivative;
    term.by = (units.asDiagonal() * term.by).eval();
    term.by.col(7).head<2>() -= of_way * term.error.head<2>();
    if (!(problem_.priors.drift_rad_per_m > 0.0)) term.by.col(6).setZero();
    if (!(problem_.priors.way > 0.0)) term.by.col(7).setZero();
    if (!(problem_.priors.turn > 0.0)) term.by.col(8).setZero();
    for (int i = 0; i < 3; ++i) {
      term.at[i] = layout_.Node(r, k) + i;
      term.at[3 + i] = layout_.Node(r, k + 1) + i;
      term.at[6 + i] = layout_.Errors(r) + i;
    }
    return term;
  }

  struct SightingTerm {
    SightingResidual residual;
    Eigen::Matrix<double, 2, 5> by;
    std::array<int, 5> at;
  };
  SightingTerm Seen(const LeastSquaresPoint& point, const Sighting& seen) const {
    const auto robot = static_cast<std::size_t>(seen.robot), node = static_cast<std::size_t>(seen.node),
               landmark = static_cast<std::size_t>(seen.landmark);
    SightingTerm term;
    term.residual = ResidualOf(point.nodes[robot][node], point.landmarks[landmark], seen, problem_.noise);
    term.by << term.residual.by_node, term.residual.by_landmark;
    for (int i = 0; i < 3; ++i) term.at[i] = layout_.Node(robot, node) + i;
    for (int i = 0; i < 2; ++i) term.at[3 + i] = layout_.Landmark(landmark) + i;
    return term;
  }

 private:
  template <int kErrors, int kUnknowns>
  void AddTerm(const Eigen::Matrix<double, kErrors, 1>& error,
               const Eigen::Matrix<double, kErrors, kUnknowns>& by, const std::array<int, kUnknowns>& at,
               const Eigen::Matrix<double, kErrors, kErrors>& weight) {
    const Eigen::Matrix<double, kUnknowns, kErrors> weighted = by.transpose() * weight;
    const Eigen::Matrix<double, kUnknowns, 1> gradient = weighted * error;
    const Eigen::Matrix<double, kUnknowns, kUnknowns> square = weighted * by;
    for (int i = 0; i < kUnknowns; ++i) {
      gradient_[at[i]] += gradient[i];
      for (int j = 0; j < kUnknowns; ++j) {
        if (at[i] >= at[j]) matrix_.Add(at[i], at[j], square(i, j));
      }
    }
  }

  void AddAnchor(const LeastSquaresPoint& point, bool linearise) {
    for (int i = 0; i < 3; ++i) {
      const double off = point.nodes[0][0][i] - anchor_[i], weight = 1.0 / SquareOfIt(kAnchor_m);
      cost_ += 0.5 * weight * off * off;
      if (!linearise) continue;
      gradient_[layout_.Node(0, 0) + i] += weight * off;
      matrix_.Add(layout_.Node(0, 0) + i, layout_.Node(0, 0) + i, weight);
    }
  }

  void AddPriors(const LeastSquaresPoint& point, std::size_t r, bool linearise) {
    const SystematicErrors& errors = point.errors[r];
    const SystematicPriors& priors = problem_.priors;
    const std::pair<double, double> of[] = {{errors.drift_rad_per_m, priors.drift_rad_per_m},
                                            {errors.way, priors.way},
                                            {errors.turn, priors.turn}};
    for (int i = 0; i < 3; ++i) {
      const int at = layout_.Errors(r) + i;
      if (!(of[i].second > 0.0)) {
        if (linearise) matrix_.Add(at, at, 1.0);
        continue;
      }
      const PriorTerm term = CauchyPrior(of[i].first, of[i].second);
      cost_ += term.cost;
      if (!linearise) continue;
      gradient_[at] += term.gradient;
      matrix_.Add(at, at, term.curvature);
    }
  }

  void AddEdge(const LeastSquaresPoint& point, std::size_t r, std::size_t k, bool linearise) {
    const EdgeTerm term = Edge(point, r, k);
    cost_ += 0.5 * term.error.dot(weights_[r][k] * term.error);
    if (linearise) AddTerm<3, 9>(term.error, term.by, term.at, weights_[r][k]);
  }

  void AddSighting(const LeastSquaresPoint& point, const Sighting& seen, bool linearise) {
    const SightingTerm term = Seen(point, seen);
    constexpr double kTail = kCauchySigmas * kCauchySigmas;
    const Eigen::Vector2d share = ShareOf(seen);
    cost_ += 0.5 * kTail * std::log1p(term.residual.error.cwiseAbs2().dot(share) / kTail);
    if (linearise)
      AddTerm<2, 5>(term.residual.error, term.by, term.at,
                    Eigen::Matrix2d((sighting_share_ * Weight(term.residual, seen) * share).asDiagonal()));
  }

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

constexpr double kMostLog = 1.1;  // of a factor on a width, at a time

// Squares of residuals, in units of a width, and how many of them are not used up by the fit.
struct Redundancy {
  double squares = 0.0, count = 0.0;
  // The likeliest factor on the width, under the prior that it is `ratio` times what it is now: with u its
  // logarithm, the least of count u + squares exp(-2 u) / 2 + (u - log(ratio))^2 / (2 kLogWidthSd^2).
  double Factor(double ratio) const {
    const double mean = std::log(ratio), weight = 1.0 / SquareOfIt(kLogWidthSd);
    double low = -kMostLog, high = kMostLog;
    for (int k = 0; k < 50; ++k) {
      const double u = 0.5 * (low + high);
      const double slope = std::max(0.0, count) - squares * std::exp(-2.0 * u) + weight * (u - mean);
      (slope < 0.0 ? low : high) = u;
    }
    return std::exp(0.5 * (low + high));
  }
};

double Rescale(const Redundancy& of, double nominal, double* width, double change) {
  if (!(*width > 0.0) || !(nominal > 0.0)) return change;
  const double factor = of.Factor(nominal / *width);
  *width *= factor;
  return std::max({change, factor, 1.0 / factor});
}

}  // namespace

Eigen::Vector2d PlaceSeen(const Eigen::Vector3d& node, const Sighting& seen) {
  const double cosine = std::cos(node[2]), sine = std::sin(node[2]);
  return {node[0] + cosine * seen.x_m - sine * seen.y_m, node[1] + sine * seen.x_m + cosine * seen.y_m};
}

Eigen::Matrix3d CovarianceOf(const EdgeSpread& spread, const EdgeWidths& widths) {
  return SquareOfIt(widths.walk_rad_per_sqrt_m) * spread.walk +
         SquareOfIt(widths.turn_rad_per_sqrt_rad) * spread.turn +
         SquareOfIt(widths.way_m_per_sqrt_m) * spread.way + spread.slip;
}

std::vector<Eigen::Vector3d> DeadReckoned(const NodeTrack& track, const Eigen::Vector3d& first,
                                          const SystematicErrors& errors) {
  std::vector<Eigen::Vector3d> nodes{first};
  for (const std::vector<Control>& controls : track.controls) {
    const Eigen::Vector3d motion = Integral(controls, errors).motion, &from = nodes.back();
    const double cosine = std::cos(from[2]), sine = std::sin(from[2]);
    nodes.emplace_back(from[0] + cosine * motion[0] - sine * motion[1],
                       from[1] + sine * motion[0] + cosine * motion[1], from[2] + motion[2]);
  }
  return nodes;
}

double CostOf(const LeastSquaresProblem& problem, const LeastSquaresPoint& point) {
  return NormalEquationsOf(problem, point).Evaluate(point, false);
}

// K. Madsen, H. Nielsen, O. Tingleff, Methods for non-linear least squares problems, 2004: algorithm 3.16
LeastSquaresEnd Descend(const LeastSquaresProblem& problem, const LeastSquaresPoint& start, int most_steps,
                        double share) {
  NormalEquationsOf equations(problem, start);
  LeastSquaresEnd end{start, equations.Evaluate(start, true)};
  double damping = 1e-6, growth = 2.0;
  while (end.steps < most_steps && !end.settled) {
    ++end.steps;
    if (!equations.Factorise(damping)) {
      damping *= growth;
      growth *= 2.0;
      continue;
    }
    const Eigen::VectorXd step = -equations.matrix().Solve(equations.gradient());
    double promised = 0.0;
    for (int k = 0; k < step.size(); ++k)
      promised += 0.5 * step[k] * (damping * equations.diagonal()[k] * step[k] - equations.gradient()[k]);
    const LeastSquaresPoint tried = equations.layout().Moved(end.point, step);
    const double cost = equations.Evaluate(tried, true);
    if (std::isfinite(cost) && cost < end.cost) {
      const double gain = (end.cost - cost) / promised;
      damping = std::max(1e-12, damping * std::max(1.0 / 9.0, 1.0 - std::pow(2.0 * gain - 1.0, 3)));
      growth = 2.0;
      end.point = tried;
      end.cost = cost;
    } else {
      equations.Evaluate(end.point, true);
      damping *= growth;
      growth *= 2.0;
    }
    end.settled = promised < kLeastDecrease + share * end.cost;
  }
  return end;
}

double ReestimateWidths(const LeastSquaresProblem& nominal, const LeastSquaresPoint& point,
                        LeastSquaresProblem* problem) {
  NormalEquationsOf equations(*problem, point);
  equations.Evaluate(point, true, kHoldingShare);
  if (!equations.Factorise(0.0)) return 0.0;
  const PathMatrix::Inverse inverse(equations.matrix());
  double change = 1.0;
  for (std::size_t r = 0; r < problem->robots.size(); ++r) {
    EdgeWidths& widths = problem->widths[r];
    Redundancy walk, turn, way;
    for (std::size_t k = 0; k < problem->robots[r].controls.size(); ++k) {
      const auto term = equations.Edge(point, r, k);
      const Eigen::Matrix3d& weight = equations.Weight(r, k);
      const Eigen::Matrix3d free = weight - weight * Fitted<3, 9>(term.by, term.at, inverse) * weight;
      const Eigen::Vector3d weighted = weight * term.error;
      const double share = std::min(1.0, kMostSquareOfMotion / term.error.dot(weighted));
      const auto add = [&](const Eigen::Matrix3d& spread, double width, Redundancy* to) {
        const Eigen::Matrix3d part = SquareOfIt(width) * spread;
        to->squares += share * weighted.dot(part * weighted);
        to->count += (part * free).trace();
      };
      const EdgeSpread& spread = equations.Spread(r, k);
      add(spread.walk, widths.walk_rad_per_sqrt_m, &walk);
      add(spread.turn, widths.turn_rad_per_sqrt_rad, &turn);
      add(spread.way, widths.way_m_per_sqrt_m, &way);
    }
    const EdgeWidths& stated = nominal.widths[r];
    change = Rescale(walk, stated.walk_rad_per_sqrt_m, &widths.walk_rad_per_sqrt_m, change);
    change = Rescale(turn, stated.turn_rad_per_sqrt_rad, &widths.turn_rad_per_sqrt_rad, change);
    change = Rescale(way, stated.way_m_per_sqrt_m, &widths.way_m_per_sqrt_m, change);
  }
  Redundancy range, bearing, contact;
  for (const Sighting& seen : problem->sightings) {
    const auto term = equations.Seen(point, seen);
    const double weight = equations.Weight(term.residual, seen);
    const Eigen::Vector2d share = equations.ShareOf(seen);
    const Eigen::Matrix2d fitted = Fitted<2, 5>(term.by, term.at, inverse);
    const auto add = [&](int k, Redundancy* to) {
      to->squares += weight * SquareOfIt(term.residual.error[k]);
      to->count += kMeanWeightedSquare * (1.0 - kHoldingShare * weight * share[k] * fitted(k, k));
    };
    add(0, seen.contact() ? &contact : &range);
    add(1, seen.contact() ? &contact : &bearing);
  }
  ObservationNoise& noise = problem->noise;
  change = Rescale(range, nominal.noise.range_m, &noise.range_m, change);
  change = Rescale(bearing, nominal.noise.bearing_rad, &noise.bearing_rad, change);
  return Rescale(contact, nominal.noise.contact_m, &noise.contact_m, change);
}

std::vector<double> SightingSigmas(const LeastSquaresProblem& problem, const LeastSquaresPoint& point) {
  const NormalEquationsOf equations(problem, point);
  std::vector<double> sigmas;
  for (const Sighting& seen : problem.sightings)
    sigmas.push_back(equations.Seen(point, seen).residual.error.norm());
  return sigmas;
}

std::vector<std::vector<double>> EdgeSigmas(const LeastSquaresProblem& problem,
                                            const LeastSquaresPoint& point) {
  const NormalEquationsOf equations(problem, point);
  std::vector<std::vector<double>> sigmas(problem.robots.size());
  for (std::size_t r = 0; r < problem.robots.size(); ++r) {
    for (std::size_t k = 0; k < problem.robots[r].controls.size(); ++k) {
      const Eigen::Vector3d error = equations.Edge(point, r, k).error;
      sigmas[r].push_back(std::sqrt(std::max(0.0, error.dot(equations.Weight(r, k) * error))));
    }
  }
  return sigmas;
}

std::vector<std::vector<double>> SightingErrors_m(const LeastSquaresProblem& problem,
                                                  const LeastSquaresPoint& point) {
  std::vector<std::vector<double>> errors_m(point.landmarks.size());
  for (const Sighting& seen : problem.sightings) {
    const auto robot = static_cast<std::size_t>(seen.robot), node = static_cast<std::size_t>(seen.node),
               landmark = static_cast<std::size_t>(seen.landmark);
    errors_m[landmark].push_back(
        (PlaceSeen(point.nodes[robot][node], seen) - point.landmarks[landmark]).norm());
  }
  return errors_m;
}

SightingRepeats RepeatsIn(const LeastSquaresProblem& problem, const LeastSquaresPoint& point) {
  const NormalEquationsOf equations(problem, point);
  std::vector<std::vector<std::optional<Eigen::Vector2d>>> before(
      problem.robots.size(), std::vector<std::optional<Eigen::Vector2d>>(point.landmarks.size()));
  Eigen::Vector2d products = Eigen::Vector2d::Zero(), squares = Eigen::Vector2d::Zero();
  double pairs = 0.0;
  for (const Sighting& seen : problem.sightings) {
    if (seen.contact()) continue;
    const Eigen::Vector2d error =
        equations.Seen(point, seen).residual.error.cwiseMin(kCauchySigmas).cwiseMax(-kCauchySigmas);
    auto& last = before[static_cast<std::size_t>(seen.robot)][static_cast<std::size_t>(seen.landmark)];
    if (last) {
      products += error.cwiseProduct(*last);
      squares += 0.5 * (error.cwiseAbs2() + last->cwiseAbs2());
      ++pairs;
    }
    last = error;
  }
  const auto repeats = [&](int k) {
    constexpr double kMost = 0.95, kSignificant = 3.0;
    const double correlation = std::min(kMost, products[k] / squares[k]);
    return correlation > kSignificant / std::sqrt(pairs) ? (1.0 + correlation) / (1.0 - correlation) : 1.0;
  };
  return pairs > 0.0 ? SightingRepeats{repeats(0), repeats(1)} : SightingRepeats{};
}

// With d the rigid motion that lays the landmarks, moved by small amounts, over where they were, d = A dl: a
// pose in the landmarks' frame is p - G d, G what a rigid motion does to it. Its covariance takes the columns
// Cov(., A dl) alone. What a landmark's sightings err by in common is no unknown, but is considered: how far
// it would shift all (S. Schmidt, Application of state-space methods to navigation problems, 1966).
LeastSquaresCovariances CovariancesOf(const LeastSquaresProblem& problem, const LeastSquaresPoint& point) {
  NormalEquationsOf equations(problem, point);
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
  for (std::size_t l = 0; l < point.landmarks.size(); ++l)
    covariances.landmarks.push_back(
        transformed.template operator()<2>(layout.Landmark(l), moved_landmark(l)));

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
  }
  return covariances;
}

}  // namespace cairn::landmark_map
