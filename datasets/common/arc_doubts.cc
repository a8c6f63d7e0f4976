#include "datasets/common/arc_doubts.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "datasets/common/reckoning.h"
#include "schema/geometry.h"
#include "schema/kinds/odometry_steps.h"

namespace cairn::datasets {
namespace {

constexpr double kLeastHalfStep_m = 0.03;

// How far what is seen again lies from where it was seen first depends on how odometry is to be read: on
// whether steps are arcs (0 to 1), on a drift of the heading in rad/m, and on the scales of turns and ways.
// The others must not be taken for the first.
constexpr int kUnknowns = 4;
using Unknowns = Eigen::Vector<double, kUnknowns>;

// Two observations that are, or may be, of one landmark.
struct SeenTwice {
  Eigen::Vector2d miss;                    // of the second, by what the robot moved, where it turns first
  Eigen::Matrix<double, 2, kUnknowns> by;  // how that changes with the unknowns
};

class PairFinder {
 public:
  PairFinder(const kinds::Log::Observations& seen, const kinds::Log::Odometry& odometry)
      : seen_(seen),
        turns_first_(odometry),
        arcs_(odometry, {.steps_are_arcs = true}),
        turns_more_(odometry, {.turn = 1 + kMore}),
        goes_more_(odometry, {.forward = 1 + kMore}) {}

  // Nothing where most of those with names lie far apart: then something else is wrong.
  std::vector<SeenTwice> Find() {
    constexpr std::size_t kMostPairs = 4000, kMostLooks = 2'000'000;
    for (std::size_t i = 0; i < seen_.time_s.size() && pairs_.size() < kMostPairs && looks_ < kMostLooks; ++i)
      if (IsFull(i)) AddPairsOf(i);
    return 2 * far_ > pairs_.size() ? std::vector<SeenTwice>() : std::move(pairs_);
  }

 private:
  // Next observations of the same landmark; of one without a name, of any where it would be.
  void AddPairsOf(std::size_t i) {
    constexpr double kLongest_s = 5, kMostDriven_m = 5, kLeastTurn_rad = 0.15, kMostTurn_rad = 1.5;
    constexpr std::size_t kNext = 4;
    const double from_s = seen_.time_s[i];
    for (std::size_t j = i + 1, found = 0; j < seen_.time_s.size() && found < kNext; ++j, ++looks_) {
      const double to_s = seen_.time_s[j],
                   turned = turns_first_.TurnedRad(to_s) - turns_first_.TurnedRad(from_s);
      if (to_s - from_s > kLongest_s || turned > kMostTurn_rad ||
          turns_first_.DrivenM(to_s) - turns_first_.DrivenM(from_s) > kMostDriven_m)
        break;
      if (turned < kLeastTurn_rad || seen_.landmark[i] != seen_.landmark[j] || !IsFull(j)) continue;
      found += Add(i, j);
    }
  }
  bool Add(std::size_t i, std::size_t j) {
    constexpr double kOther_m = 0.5;
    const Eigen::Vector2d miss = Miss(i, j, turns_first_), of_arcs = Miss(i, j, arcs_);
    if (std::min(miss.norm(), of_arcs.norm()) > kOther_m) {
      far_ += seen_.landmark[i] >= 0;
      return seen_.landmark[i] >= 0;
    }
    SeenTwice pair{miss, {}};
    pair.by << of_arcs - miss, (Miss(i, j, turns_first_, kStep_rad_per_m) - miss) / kStep_rad_per_m,
        (Miss(i, j, turns_more_) - miss) / kMore, (Miss(i, j, goes_more_) - miss) / kMore;
    pairs_.push_back(pair);
    return true;
  }
  // Of what the heading drifts half turns what was driven.
  Eigen::Vector2d Miss(std::size_t i, std::size_t j, const Reckoning& odometry,
                       double drift_rad_per_m = 0) const {
    const double from_s = seen_.time_s[i], to_s = seen_.time_s[j];
    const Pose half{0, 0, 0.5 * drift_rad_per_m * (odometry.DrivenM(to_s) - odometry.DrivenM(from_s))};
    const Pose moved = Compose(Compose(half, Between(odometry.At(from_s), odometry.At(to_s))), half);
    const Pose second = Compose(moved, At(j)), first = At(i);
    return {second.x_m - first.x_m, second.y_m - first.y_m};
  }
  Pose At(std::size_t i) const {
    return {seen_.range_m[i] * std::cos(seen_.bearing_rad[i]),
            seen_.range_m[i] * std::sin(seen_.bearing_rad[i]), 0};
  }
  bool IsFull(std::size_t i) const {
    return std::isfinite(seen_.range_m[i]) && std::isfinite(seen_.bearing_rad[i]);
  }

  static constexpr double kStep_rad_per_m = 0.01, kMore = 0.02;

  const kinds::Log::Observations& seen_;
  Reckoning turns_first_, arcs_, turns_more_, goes_more_;
  std::vector<SeenTwice> pairs_;
  std::size_t far_ = 0, looks_ = 0;
};

// Normal equations.
struct Sums {
  Eigen::Matrix<double, kUnknowns, kUnknowns> matrix = Eigen::Matrix<double, kUnknowns, kUnknowns>::Zero();
  Unknowns gradient = Unknowns::Zero();
  Unknowns Solved() const { return -matrix.ldlt().solve(gradient); }
};

// What is known before: on a circle drift, turns and arcs look alike.
Sums PriorOf(double scale_m) {
  constexpr double kDrift_rad_per_m = 0.2, kScale = 0.3;
  Sums prior;
  prior.matrix(1, 1) = std::pow(scale_m / kDrift_rad_per_m, 2);
  prior.matrix(2, 2) = prior.matrix(3, 3) = std::pow(scale_m / kScale, 2);
  return prior;
}

Sums SumOver(std::span<const SeenTwice> pairs, double scale_m, const Unknowns& at, Sums sums = {}) {
  for (const auto& [miss, by] : pairs) {
    const double rest_m = (miss + by * at).norm();
    const double weight = 1 / (1 + std::pow(rest_m / scale_m, 2));  // other landmarks, false observations
    sums.matrix += weight * by.transpose() * by;
    sums.gradient += weight * by.transpose() * miss;
  }
  return sums;
}

// The middle one of what is left of the misses.
double MiddleRest_m(std::span<const SeenTwice> pairs, const Unknowns& at) {
  std::vector<double> rests_m;
  for (const auto& [miss, by] : pairs) rests_m.push_back((miss + by * at).norm());
  const auto middle = rests_m.begin() + std::ssize(rests_m) / 2;
  std::ranges::nth_element(rests_m, middle);
  return *middle;
}

// By leaving out one part of the drive after the other: errors of odometry go on from pair to pair.
double SdOf(const std::vector<Sums>& parts, const Sums& all) {
  double squares = 0;
  for (const Sums& part : parts) {
    const Sums rest{all.matrix - part.matrix, all.gradient - part.gradient};
    squares += std::pow((rest.Solved() - all.Solved())[0], 2);
  }
  const auto n = static_cast<double>(parts.size());
  return std::sqrt((n - 1) / n * squares);
}

}  // namespace

std::optional<StepArcs> FindStepArcs(const kinds::Log::Observations& seen,
                                     const kinds::Log::Odometry& odometry) {
  constexpr std::size_t kFewPairs = 40, kParts = 20;
  constexpr double kMostRest_m = 0.2;
  constexpr int kRounds = 5;
  const double half_step_m = HalfStep_m(odometry);
  if (std::abs(half_step_m) < kLeastHalfStep_m) return std::nullopt;
  const std::vector<SeenTwice> pairs = PairFinder(seen, odometry).Find();
  const std::size_t count = pairs.size();
  if (count < kFewPairs) return std::nullopt;
  const double scale_m = std::max(0.01, 2 * MiddleRest_m(pairs, Unknowns::Zero()));
  const Sums prior = PriorOf(scale_m);
  Unknowns found = Unknowns::Zero();
  for (int round = 0; round < kRounds; ++round) found = SumOver(pairs, scale_m, found, prior).Solved();
  std::vector<Sums> parts;
  Sums all = prior;
  for (std::size_t p = 0; p < kParts; ++p) {
    const std::size_t from = p * count / kParts, until = (p + 1) * count / kParts;
    parts.push_back(SumOver(std::span(pairs).subspan(from, until - from), scale_m, found));
    all.matrix += parts.back().matrix;
    all.gradient += parts.back().gradient;
  }
  // Of odometry that errs by more the pairs that lie near are a choice.
  const Unknowns most{std::numeric_limits<double>::infinity(), 0.03, 0.2, 0.2}, errs = all.Solved();
  if (!(errs.array().abs() < most.array()).all() || MiddleRest_m(pairs, errs) > kMostRest_m)
    return std::nullopt;
  return StepArcs{errs[0], SdOf(parts, all), count, half_step_m};
}

std::optional<std::string> DoubtSteps(const kinds::Log::Observations& seen,
                                      const kinds::Log::Odometry& odometry) {
  // Beyond, something else moves what is seen, more than half a step does.
  constexpr double kLeast = 0.6, kMost = 2, kSigmas = 5;
  const std::optional<StepArcs> found = FindStepArcs(seen, odometry);
  if (!found) return std::nullopt;
  const bool is_clear =
      found->share >= kLeast && found->share <= kMost && found->share >= kSigmas * found->sd;
  if (!is_clear) return std::nullopt;
  return fmt::format(
      "of {} pairs of observations: its rows turn and go at once, and it turned along the way rather than "
      "before it ({:.2g} +- {:.2g}, where 0 is before and 1 along; half a step is {:.2f} m): "
      "`--steps-are-arcs` reads a CSV so. A sensor that sits so far behind where the robot turns about looks "
      "alike",
      found->pairs, found->share, found->sd, found->half_step_m);
}

}  // namespace cairn::datasets
