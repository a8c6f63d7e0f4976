#include "pipelines/landmark_map/state/schedule.h"

#include <algorithm>
#include <cmath>

namespace cairn::landmark_map {

Schedule Schedule::Next(const Options& options, std::int64_t all_robots, double log_likelihood_now,
                        double observations) const {
  Schedule next = *this;
  ++next.iteration;
  next.log_likelihood = log_likelihood_now;
  if (prefix < 1.0) {
    next.prefix = std::min(1.0, prefix * growth);
    return next;
  }
  ++next.settled;
  const double change = std::abs(log_likelihood_now - log_likelihood);
  const bool converged = settled > 0 && change < options.tolerance * observations;
  if (next.settled < options.iterations && !converged) return next;
  if (robots < all_robots) {
    next.robots = all_robots;
    next.settled = 0;
  } else {
    next.phase = Phase::kSummary;
  }
  return next;
}

}  // namespace cairn::landmark_map
