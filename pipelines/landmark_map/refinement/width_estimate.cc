#include "pipelines/landmark_map/refinement/width_estimate.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "pipelines/landmark_map/refinement/joint_equations.h"
#include "schema/square.h"

namespace cairn::landmark_map {
namespace {

// What the mean of a sighting's weighted square is of a Gaussian's: E[s / (1 + s / 9)] / 2, s a chi square of
// two.
constexpr double kMeanWeightedSquare = 0.7205;
// No motion's square counts more: a robot that was carried does not tell how wide odometry's errors are.
constexpr double kMostSquareOfMotion = 9.0;

// What of a sighting's curvature holds the motions, where their residuals are compared with what is expected
// of them: with a the mean of the score's derivative (0.7205), b that of its square (0.5372), A the motions'
// matrix and H the sightings', a residual's covariance lacks M^-1 (A + (2 a - b) H) M^-1 with M = A + a H,
// which is (A + b H)^-1 to first order; in the equations H counts 0.8399, its mean weight.
constexpr double kHoldingShare = 0.5372 / 0.8399;

constexpr double kMostLog = 1.1;  // of a factor on a width, at a time

// Squares of residuals, in units of a width, and how many of them are not used up by the fit.
struct Redundancy {
  double squares = 0.0, count = 0.0;
  // The likeliest factor on the width, under the prior that it is `ratio` times what it is now: with u its
  // logarithm, the least of count u + squares exp(-2 u) / 2 + (u - log(ratio))^2 / (2 kLogWidthSd^2).
  double Factor(double ratio) const {
    const double mean = std::log(ratio), weight = 1.0 / Square(kLogWidthSd);
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

double ReestimateWidths(const LeastSquaresProblem& nominal, const LeastSquaresPoint& point,
                        LeastSquaresProblem* problem) {
  JointEquations equations(*problem, point);
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
        const Eigen::Matrix3d part = Square(width) * spread;
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
    const Eigen::Matrix2d fitted = Fitted<2, 6>(term.by, term.at, inverse);
    const auto add = [&](int k, Redundancy* to) {
      to->squares += weight * Square(term.residual.error[k]);
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

SightingRepeats RepeatsIn(const LeastSquaresProblem& problem, const LeastSquaresPoint& point) {
  const JointEquations equations(problem, point);
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

}  // namespace cairn::landmark_map
