#include "pipelines/landmark_map/refinement/width_estimate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "pipelines/landmark_map/refinement/broken_motion.h"
#include "pipelines/landmark_map/refinement/joint_equations.h"
#include "schema/square.h"

namespace cairn::landmark_map {
namespace {

// No motion's square counts more: a robot that was carried does not tell how wide odometry's errors are.
constexpr double kMostSquareOfMotion = 9.0;

// What Gaussian sightings come to under weights w = 1 / (1 + s / k^2), s a chi square of two, k where the
// tails begin: with z = k^2 / 2 the mean weight is E[w] = z exp(z) E1(z), the rest by parts.
struct MeansUnderTail {
  // E[w s] / 2, which is E[w^2], the mean of the score's derivative, too.
  double weighted_square;
  // What of a sighting's curvature holds the motions, where their residuals are compared with what is
  // expected of them: with a the mean of the score's derivative, b that of its square (E[w^2 s] / 2), A the
  // motions' matrix and H the sightings', a residual's covariance lacks M^-1 (A + (2 a - b) H) M^-1 with M =
  // A + a H, which is (A + b H)^-1 to first order; in the equations H counts its mean weight.
  double holding_share;
};
MeansUnderTail MeansUnder(double tail_sigmas) {
  const double z = 0.5 * Square(tail_sigmas);
  const double weight = -z * std::exp(z) * std::expint(-z), weighted_square = z * (1.0 - weight);
  return {weighted_square, z * (weight - weighted_square) / weight};
}

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

// Of odometry. `equations`: of the problem about the point.
double RescaleMotions(const std::vector<EdgeWidths>& expected, const JointEquations& equations,
                      const PathMatrix::Inverse& inverse, const LeastSquaresPoint& point,
                      LeastSquaresProblem* problem) {
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
    const EdgeWidths& stated = expected[r];
    change = Rescale(walk, stated.walk_rad_per_sqrt_m, &widths.walk_rad_per_sqrt_m, change);
    change = Rescale(turn, stated.turn_rad_per_sqrt_rad, &widths.turn_rad_per_sqrt_rad, change);
    change = Rescale(way, stated.way_m_per_sqrt_m, &widths.way_m_per_sqrt_m, change);
  }
  return change;
}

}  // namespace

double ReestimateWidths(const ExpectedWidths& expected, const LeastSquaresPoint& point,
                        LeastSquaresProblem* problem) {
  problem->repeats = RepeatsIn(*problem, point);
  problem->tail_sigmas = TailOf(*problem, point);
  JointEquations equations(*problem, point);
  const MeansUnderTail means = MeansUnder(problem->tail_sigmas);
  equations.Evaluate(point, true, means.holding_share);
  if (!equations.Factorise(0.0)) return 0.0;
  const PathMatrix::Inverse inverse(equations.matrix());
  double change = RescaleMotions(expected.odometry, equations, inverse, point, problem);
  Redundancy range, bearing, contact;
  for (const Sighting& seen : problem->sightings) {
    const auto term = equations.Seen(point, seen);
    const double weight = equations.Weight(term.residual, seen);
    const Eigen::Vector2d share = equations.ShareOf(seen);
    const Eigen::Matrix2d fitted = Fitted<2, 6>(term.by, term.at, inverse);
    const auto add = [&](int k, Redundancy* to) {
      to->squares += weight * Square(term.residual.error[k]);
      to->count += means.weighted_square * (1.0 - means.holding_share * weight * share[k] * fitted(k, k));
    };
    add(0, seen.contact() ? &contact : &range);
    add(1, seen.contact() ? &contact : &bearing);
  }
  ObservationNoise& noise = problem->noise;
  change = Rescale(range, expected.sightings.range_m, &noise.range_m, change);
  change = Rescale(bearing, expected.sightings.bearing_rad, &noise.bearing_rad, change);
  return Rescale(contact, expected.sightings.contact_m, &noise.contact_m, change);
}

// Widths of odometry come down from far above by a fifth a round. Where a sensor's errors go on, odometry
// takes them up, the more the longer that is let go on: so it is not (MRCLAM 6: a scale of 1.14 in the end).
// Nor where sightings have no names: a landmark that is in the map twice would make odometry as exact as it
// takes to stay there twice.
bool SettleWidths(const ExpectedWidths& expected, LeastSquaresProblem* problem, LeastSquaresEnd* end) {
  constexpr int kStepsARound = 3;
  struct Until {
    int rounds;
    double settled;  // factor on a width
  };
  constexpr Until kOwnErrors{20, 1.01}, kFew{4, 1.1};
  for (int round = 1;; ++round) {
    const double change = ReestimateWidths(expected, end->point, problem);
    if (change == 0.0) return false;
    const bool go_on = problem->repeats.along > 1.0 || problem->repeats.across > 1.0;
    const Until& until = go_on || !problem->named ? kFew : kOwnErrors;
    if (change < until.settled) break;
    *end = Descend(*problem, end->point, kStepsARound);
    if (round >= until.rounds) break;
  }
  *end = Descend(*problem, end->point);
  return true;
}

bool SettleOdometryWidths(const std::vector<EdgeWidths>& expected, LeastSquaresProblem* problem,
                          LeastSquaresEnd* end) {
  constexpr int kStepsARound = 3, kRounds = 20;
  constexpr double kSettled = 1.02;
  for (int round = 0; round < kRounds; ++round) {
    JointEquations equations(*problem, end->point);
    equations.Evaluate(end->point, true, MeansUnder(problem->tail_sigmas).holding_share);
    if (!equations.Factorise(0.0)) return false;
    const double change =
        RescaleMotions(expected, equations, PathMatrix::Inverse(equations.matrix()), end->point, problem);
    if (change < kSettled) break;
    *end = Descend(*problem, end->point, kStepsARound);
  }
  *end = Descend(*problem, end->point);
  return true;
}

double NegativeLogEvidence(const std::vector<EdgeWidths>& expected, const LeastSquaresProblem& problem,
                           const LeastSquaresPoint& point) {
  JointEquations equations(problem, point);
  equations.Evaluate(point, true);
  if (!equations.Factorise(0.0)) return std::numeric_limits<double>::infinity();
  double nats = NegativeLogDensity(problem, point) + 0.5 * equations.matrix().LogDeterminant();
  const auto add = [&](double width, double of) {
    if (width > 0.0 && of > 0.0) nats += 0.5 * Square(std::log(width / of) / kLogWidthSd);
  };
  for (std::size_t r = 0; r < expected.size(); ++r) {
    const EdgeWidths &widths = problem.widths[r], &of = expected[r];
    add(widths.walk_rad_per_sqrt_m, of.walk_rad_per_sqrt_m);
    add(widths.turn_rad_per_sqrt_rad, of.turn_rad_per_sqrt_rad);
    add(widths.way_m_per_sqrt_m, of.way_m_per_sqrt_m);
  }
  return nats;
}

// Their logarithm's sum over the sightings, for widths that are a common factor times the problem's, the
// likeliest: that of squares s^2 where the mean of w q / s^2 is two, q the squares in the problem's widths.
double TailOf(const LeastSquaresProblem& problem, const LeastSquaresPoint& point) {
  constexpr int kSteps = 30;
  std::vector<double> squares;
  double sum = 0.0;
  for (const double sigmas : SightingSigmas(problem, point)) {
    squares.push_back(Square(sigmas));
    sum += squares.back();
  }
  const auto count = static_cast<double>(squares.size());
  if (!(sum > 0.0)) return kCauchySigmas;
  double likeliest = kCauchySigmas, most_nats = -std::numeric_limits<double>::infinity();
  for (const double tail_sigmas : {kCauchySigmas, 4.0, 6.0, 10.0}) {
    const double tail = Square(tail_sigmas);
    double factor = 0.5 * sum / count;
    for (int k = 0; k < kSteps; ++k) {
      double weighted = 0.0;
      for (const double square : squares) weighted += square / (1.0 + square / (factor * tail));
      factor = 0.5 * weighted / count;
    }
    double nats = count * (LogTailNorm(tail_sigmas) - std::log(factor));
    for (const double square : squares) nats -= 0.5 * tail * std::log1p(square / (factor * tail));
    if (nats > most_nats) {
      most_nats = nats;
      likeliest = tail_sigmas;
    }
  }
  return likeliest;
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
