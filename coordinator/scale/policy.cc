#include "coordinator/scale/policy.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace cairn::coordinator {

int WorkersWanted(const PolicyOptions& options, const std::vector<wire::Demand>& demand) {
  double worth = 0;
  for (const wire::Demand& job : demand)
    worth += std::min(static_cast<double>(job.tasks()), job.work_s() / options.work_s);
  const double wanted = demand.empty() ? 0 : std::max(1.0, std::ceil(worth));
  return std::max(options.least, static_cast<int>(std::min<double>(wanted, options.most)));
}

Decision Decide(const PolicyOptions& options, const std::vector<wire::Demand>& demand, int others,
                const std::vector<ScaledWorker>& ours, double started_s) {
  using State = ScaledWorker::State;
  PolicyOptions beside = options;
  beside.most = options.most + others;
  const int wanted = std::max(options.least, WorkersWanted(beside, demand) - others);
  const auto have = static_cast<int>(std::ranges::count_if(
      ours, [](const ScaledWorker& worker) { return worker.state != State::kLeaving; }));
  const auto places = static_cast<int>(ours.size());
  Decision decision;
  // Those that leave have their places until they are gone.
  decision.start = std::max(0, std::min(wanted - have, options.most - places));
  const auto here = static_cast<int>(std::ranges::count_if(ours, [](const ScaledWorker& worker) {
    return worker.state == State::kIdle || worker.state == State::kBusy;
  }));
  const int over = here - options.most;
  const bool cooled = started_s >= options.cool_down_s;
  const int surplus = std::max(over, cooled ? have - wanted : 0);
  if (surplus <= 0) return decision;
  std::vector<std::size_t>& leave = decision.leave;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    const bool free = ours[i].state == State::kWaiting || ours[i].state == State::kIdle;
    if ((free && ours[i].for_s >= options.idle_s) || (over > 0 && (free || ours[i].state == State::kBusy)))
      leave.push_back(i);
  }
  std::ranges::stable_sort(leave, [&ours](std::size_t a, std::size_t b) {
    if (ours[a].state != ours[b].state) return ours[a].state < ours[b].state;
    return ours[a].for_s > ours[b].for_s;
  });
  leave.resize(std::min(leave.size(), static_cast<std::size_t>(surplus)));
  return decision;
}

}  // namespace cairn::coordinator
