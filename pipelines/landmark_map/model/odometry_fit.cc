#include "pipelines/landmark_map/model/odometry_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipelines/common/handed_over.h"
#include "schema/square.h"

namespace cairn::landmark_map {
namespace {

constexpr double kLargestChange = 2.0;     // of a width in one M-step
constexpr double kLeastShare = 1.0 / 3.0;  // of the nominal width

void Add(const WidthEvidence& from, double weight, WidthEvidence* to) {
  to->squares += weight * from.squares;
  to->known += weight * from.known;
}

// One kind of width of all robots: where it stands in a fit, and its evidence.
void FitWidth(const std::vector<IncrementSums>& sums, const WidthEvidence& (IncrementSums::*evidence)() const,
              double OdometryFit::* width, double nominal, std::vector<OdometryFit>* fits) {
  double squares = kPriorIncrements * Square(nominal), known = kPriorIncrements;
  for (std::size_t r = 0; r < sums.size(); ++r) {
    squares += (sums[r].*evidence)().squares * Square((*fits)[r].*width);
    known += (sums[r].*evidence)().known;
  }
  const double mean_square = squares / known;
  for (std::size_t r = 0; r < sums.size(); ++r) {
    double& now = (*fits)[r].*width;
    const double own = (sums[r].*evidence)().squares * Square(now) + kPriorIncrements * mean_square;
    // [TBF98] section 2.1 takes the width as given; here the M-step fits it.
    const double fitted = std::sqrt(own / ((sums[r].*evidence)().known + kPriorIncrements));
    now = std::max(kLeastShare * nominal, std::clamp(fitted, now / kLargestChange, now * kLargestChange));
  }
}

}  // namespace

void OdometryFit::Check() const {
  constexpr double kMost = 1e6;
  RequireWithin("drift_rad_per_m", drift_rad_per_m, -kMost, kMost);
  RequireWithin("heading_walk_rad_per_sqrt_m", heading_walk_rad_per_sqrt_m, 0.0, kMost);
  RequireWithin("turn_ratio", turn_ratio, 0.0, kMost);
}

MotionNoise OdometryFit::Widths(MotionNoise nominal) const {
  nominal.heading_walk_rad_per_sqrt_m = heading_walk_rad_per_sqrt_m;
  nominal.turn_ratio = turn_ratio;
  return nominal;
}

void IncrementSums::AddHeading(double heading_rad, double next_path_m) {
  if (any_) {
    turned_rad_ += std::remainder(first_rad_ - heading_rad, 2.0 * std::numbers::pi);
    path_m_ += next_path_m;
  } else {
    last_rad_ = heading_rad;
  }
  first_rad_ = heading_rad;
  any_ = true;
}

// For an error e ~ N(0, v) whose posterior has mean m and variance s the data have told 1 - s / v of it, and
// v is right where m^2 / v adds up to the same: D. MacKay, Bayesian Interpolation, Neural Computation 4,
// 1992. EM proper has the same fixed points but hardly moves where s is nearly v, as it is where a motion
// increment's error is below the grid's step. Where several places are possible s exceeds v: an error that is
// large, if of unknown sign. Both halves of a motion increment's turn count, of which the E-step looks at the
// first.
void IncrementSums::AddIncrement(const MotionIncrement& increment, const HalfTurn& posterior,
                                 const MotionNoise& widths) {
  const double variance = posterior.prior_rad2;
  const double all = Square(ErrorOf(increment, widths).heading_rad);
  if (!(variance > 0.0) || !(all > 0.0)) return;
  const double share = posterior.variance_rad2 / variance;
  constexpr double kHalves = 2.0;
  const WidthEvidence evidence{kHalves * (Square(posterior.mean_rad) / variance + std::max(0.0, share - 1.0)),
                               kHalves * (1.0 - std::min(1.0, share))};
  Add(evidence, Square(widths.heading_walk_rad_per_sqrt_m) * increment.path_m / all, &walk_);
  Add(evidence, Square(widths.turn_ratio * increment.turn_rad) / all, &turn_);
}

void IncrementSums::Join(const IncrementSums& earlier, double link_path_m) {
  if (!any_) {
    *this = earlier;
    return;
  }
  AddHeading(earlier.last_rad_, link_path_m);
  turned_rad_ += earlier.turned_rad_;
  path_m_ += earlier.path_m_;
  first_rad_ = earlier.first_rad_;
  Add(earlier.walk_, 1.0, &walk_);
  Add(earlier.turn_, 1.0, &turn_);
}

double FitDrift(const IncrementSums& sums, const MotionNoise& nominal, double so_far) {
  const double path_m = sums.path_m();
  if (!(path_m > 0.0)) return so_far;
  const double prior = Square(nominal.heading_drift_rad_per_m);
  const double evidence = Square(nominal.heading_walk_rad_per_sqrt_m) / path_m;
  if (!(prior + evidence > 0.0)) return so_far;
  return (so_far - sums.turned_rad() / path_m) * prior / (prior + evidence);
}

void FitWidths(const std::vector<IncrementSums>& sums, const MotionNoise& nominal,
               std::vector<OdometryFit>* fits) {
  FitWidth(sums, &IncrementSums::walk, &OdometryFit::heading_walk_rad_per_sqrt_m,
           nominal.heading_walk_rad_per_sqrt_m, fits);
  FitWidth(sums, &IncrementSums::turn, &OdometryFit::turn_ratio, nominal.turn_ratio, fits);
}

}  // namespace cairn::landmark_map
