#include "pipelines/landmark_map/refinement/joint_equations.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "schema/square.h"

namespace cairn::landmark_map {
namespace {

constexpr double kAnchor_m = 1e-2;  // standard deviation that holds the first pose: nothing else pulls at it
constexpr double kLeastDistance_m = 0.01;          // nearer than that there is no bearing
const Eigen::Vector3d kBroken(100.0, 100.0, 1.0);  // variances of a motion that is broken: m^2, m^2, rad^2
constexpr double kUnheld = 1e5;                    // of an unknown that no residual is of

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

SightingResidual ResidualOf(const Eigen::Vector3d& node, const Eigen::Vector2d& landmark, double offset_m,
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
    residual.by_offset.setZero();
  } else {
    // The bearing itself: measured across, in metres, a smaller map would have smaller errors.
    const double range = std::hypot(seen.x_m, seen.y_m), distance = std::max(kLeastDistance_m, there.norm());
    const double turn =
        std::atan2(seen.x_m * there.y() - seen.y_m * there.x(), seen.x_m * there.x() + seen.y_m * there.y());
    residual.error << there.norm() + offset_m - range, range * turn;
    residual.by_offset << 1.0, 0.0;
    by_there << there.x(), there.y(), -range * there.y() / distance, range * there.x() / distance;
    by_there /= distance;
  }
  residual.error = residual.error.cwiseQuotient(Eigen::Vector2d(widths.along_m, widths.across_m));
  by_there.row(0) /= widths.along_m;
  by_there.row(1) /= widths.across_m;
  residual.by_offset /= widths.along_m;
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
  const double square = Square(value / scale), curvature = 2.0 / (Square(scale) * (1.0 + square));
  return {std::log1p(square), curvature * value, curvature};
}

}  // namespace

UnknownLayout::UnknownLayout(const LeastSquaresProblem& problem) {
  for (const NodeTrack& track : problem.robots) {
    first_.push_back(size_);
    size_ += 3 * static_cast<int>(track.time_s.size());
  }
  landmarks_ = size_;
  errors_ = size_ + 2 * problem.landmarks;
  size_ = errors_ + kSystematic * static_cast<int>(problem.robots.size());
}

PathMatrix UnknownLayout::Matrix(const LeastSquaresProblem& problem) const {
  std::vector<int> chains;
  std::vector<PathMatrix::Coupling> couplings;
  for (std::size_t r = 0; r < problem.robots.size(); ++r) {
    const int nodes = static_cast<int>(problem.robots[r].time_s.size());
    chains.push_back(nodes);
    for (int k = 0; k < nodes; ++k)
      for (int i = 0; i < kSystematic; ++i)
        couplings.push_back({first_[r] / 3 + k, Errors(r) + i - landmarks_});
  }
  for (const Sighting& seen : problem.sightings)
    for (int i = 0; i < 2; ++i)
      couplings.push_back(
          {first_[static_cast<std::size_t>(seen.robot)] / 3 + seen.node, 2 * seen.landmark + i});
  return {chains, size_ - landmarks_, couplings};
}

LeastSquaresPoint UnknownLayout::Moved(LeastSquaresPoint point, const Eigen::VectorXd& step) const {
  for (std::size_t r = 0; r < point.nodes.size(); ++r) {
    for (std::size_t k = 0; k < point.nodes[r].size(); ++k) point.nodes[r][k] += step.segment<3>(Node(r, k));
    const int at = Errors(r);
    point.errors[r].drift_rad_per_m += step[at];
    point.errors[r].way += step[at + 1];
    point.errors[r].turn += step[at + 2];
    point.errors[r].range_m += step[at + 3];
  }
  for (std::size_t l = 0; l < point.landmarks.size(); ++l) point.landmarks[l] += step.segment<2>(Landmark(l));
  return point;
}

JointEquations::JointEquations(const LeastSquaresProblem& problem, const LeastSquaresPoint& at)
    : problem_(problem), layout_(problem), anchor_(at.nodes[0][0]), matrix_(layout_.Matrix(problem)) {
  for (std::size_t r = 0; r < problem.robots.size(); ++r) {
    auto& spreads = spreads_.emplace_back();
    auto& weights = weights_.emplace_back();
    const NodeTrack& track = problem.robots[r];
    for (std::size_t k = 0; k < track.controls.size(); ++k) {
      spreads.push_back(SpreadOf(track.controls[k], at.errors[r]));
      spreads.back().slip.diagonal() += problem.loose;
      if (track.IsBroken(k)) spreads.back().slip.diagonal() += kBroken;
      weights.push_back(CovarianceOf(spreads.back(), problem.widths[r]).inverse());
    }
  }
}

double JointEquations::Evaluate(const LeastSquaresPoint& point, bool linearise, double sighting_share) {
  cost_ = 0.0;
  sighting_share_ = sighting_share;
  if (linearise) {
    matrix_.SetZero();
    gradient_ = Eigen::VectorXd::Zero(layout_.size());
    for (int k = 0; k < layout_.size(); ++k) matrix_.Add(k, k, 1.0 / Square(kUnheld));
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

Eigen::Vector2d JointEquations::ShareOf(const Sighting& seen) const {
  if (seen.contact()) return {1.0, 1.0};
  return {1.0 / problem_.repeats.along, 1.0 / problem_.repeats.across};
}

std::vector<Eigen::VectorXd> JointEquations::CommonErrors(const LeastSquaresPoint& point) const {
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
      for (int i = 0; i < 6; ++i) error[term.at[i]] += pull * term.by(k, i);
    }
  }
  return errors;
}

double JointEquations::Weight(const SightingResidual& residual, const Sighting& seen) const {
  return 1.0 / (1.0 + residual.error.cwiseAbs2().dot(ShareOf(seen)) / Square(problem_.tail_sigmas));
}

JointEquations::EdgeTerm JointEquations::Edge(const LeastSquaresPoint& point, std::size_t r,
                                              std::size_t k) const {
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

JointEquations::SightingTerm JointEquations::Seen(const LeastSquaresPoint& point,
                                                  const Sighting& seen) const {
  const auto robot = static_cast<std::size_t>(seen.robot), node = static_cast<std::size_t>(seen.node),
             landmark = static_cast<std::size_t>(seen.landmark);
  SightingTerm term;
  term.residual = ResidualOf(point.nodes[robot][node], point.landmarks[landmark], point.errors[robot].range_m,
                             seen, problem_.noise);
  term.by << term.residual.by_node, term.residual.by_landmark, term.residual.by_offset;
  if (!(problem_.priors.range_m > 0.0)) term.by.col(5).setZero();
  for (int i = 0; i < 3; ++i) term.at[i] = layout_.Node(robot, node) + i;
  for (int i = 0; i < 2; ++i) term.at[3 + i] = layout_.Landmark(landmark) + i;
  term.at[5] = layout_.Errors(robot) + 3;
  return term;
}

template <int kErrors, int kUnknowns>
void JointEquations::AddTerm(const Eigen::Matrix<double, kErrors, 1>& error,
                             const Eigen::Matrix<double, kErrors, kUnknowns>& by,
                             const std::array<int, kUnknowns>& at,
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

void JointEquations::AddAnchor(const LeastSquaresPoint& point, bool linearise) {
  for (int i = 0; i < 3; ++i) {
    const double off = point.nodes[0][0][i] - anchor_[i], weight = 1.0 / Square(kAnchor_m);
    cost_ += 0.5 * weight * off * off;
    if (!linearise) continue;
    gradient_[layout_.Node(0, 0) + i] += weight * off;
    matrix_.Add(layout_.Node(0, 0) + i, layout_.Node(0, 0) + i, weight);
  }
}

void JointEquations::AddPriors(const LeastSquaresPoint& point, std::size_t r, bool linearise) {
  const SystematicErrors& errors = point.errors[r];
  const SystematicPriors& priors = problem_.priors;
  const std::pair<double, double> of[] = {{errors.drift_rad_per_m, priors.drift_rad_per_m},
                                          {errors.way, priors.way},
                                          {errors.turn, priors.turn},
                                          {errors.range_m, priors.range_m}};
  for (int i = 0; i < kSystematic; ++i) {
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

void JointEquations::AddEdge(const LeastSquaresPoint& point, std::size_t r, std::size_t k, bool linearise) {
  const EdgeTerm term = Edge(point, r, k);
  cost_ += 0.5 * term.error.dot(weights_[r][k] * term.error);
  if (linearise) AddTerm<3, 9>(term.error, term.by, term.at, weights_[r][k]);
}

void JointEquations::AddSighting(const LeastSquaresPoint& point, const Sighting& seen, bool linearise) {
  const SightingTerm term = Seen(point, seen);
  const double tail = Square(problem_.tail_sigmas);
  const Eigen::Vector2d share = ShareOf(seen);
  cost_ += 0.5 * tail * std::log1p(term.residual.error.cwiseAbs2().dot(share) / tail);
  if (linearise)
    AddTerm<2, 6>(term.residual.error, term.by, term.at,
                  Eigen::Matrix2d((sighting_share_ * Weight(term.residual, seen) * share).asDiagonal()));
}

}  // namespace cairn::landmark_map
