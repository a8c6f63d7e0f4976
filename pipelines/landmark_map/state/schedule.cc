#include "pipelines/landmark_map/state/schedule.h"

#include <algorithm>
#include <cmath>

#include "pipelines/common/handed_over.h"

namespace cairn::landmark_map {

std::int64_t IterationsApart(const Settings& settings) {
  constexpr std::int64_t kApart = 5;
  return settings.gauge_free && (settings.map.types == 0 || settings.joins_by_geometry) ? kApart : 0;
}

Schedule Schedule::Load(const State& state, std::size_t all_robots) {
  constexpr std::int64_t kMost = 1 << 30;
  const auto schedule = ScalarsIn<Schedule>(state);
  RequireWithin("the phase", static_cast<std::int64_t>(schedule.phase), 0,
                static_cast<std::int64_t>(Phase::kRefinedSummary));
  RequireWithin("the iteration", schedule.iteration, 0, kMost);
  RequireWithin("the share of the data", schedule.prefix, 1e-9, 1.0);
  RequireWithin("the number of robots", schedule.robots, 1, static_cast<std::int64_t>(all_robots));
  RequireWithin("the iterations on all data", schedule.settled, 0, kMost);
  RequireWithin("the growth", schedule.growth, 1.001, 1e9);
  RequireWithin("the iterations apart", schedule.apart, 0, kMost);
  return schedule;
}

bool Schedule::StartsNearby(std::size_t robot) const {
  if (apart == 0 || robots < 2 || settled == 0) return false;
  return robot == 0 || settled > apart + 1 || (robots == 2 && settled <= apart);
}

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
  // Apart they settle in maps that nobody keeps.
  const bool converged = settled > (robots > 1 ? apart : 0) && change < options.tolerance * observations;
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
