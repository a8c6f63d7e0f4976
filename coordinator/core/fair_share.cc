#include "coordinator/core/fair_share.h"

#include <algorithm>
#include <cmath>

namespace cairn::coordinator {
namespace {

constexpr double kLeast_s = 1e-3;  // of a turn: none is free

}  // namespace

void FairShare::Offer(std::uint64_t job) {
  double& clock = clocks_[job];
  if (ready_.contains({clock, job})) return;
  clock = std::max(clock, now_);
  ready_.insert({clock, job});
}

void FairShare::Withdraw(std::uint64_t job) {
  const auto it = clocks_.find(job);
  if (it != clocks_.end()) ready_.erase({it->second, job});
}

void FairShare::Forget(std::uint64_t job) {
  Withdraw(job);
  clocks_.erase(job);
}

std::optional<std::uint64_t> FairShare::Next() const {
  return ready_.empty() ? std::nullopt : std::optional(ready_.begin()->second);
}

void FairShare::Charge(std::uint64_t job, double seconds, int priority) {
  double& clock = clocks_[job];
  const bool ready = ready_.erase({clock, job}) > 0;
  if (ready) now_ = std::max(now_, clock);
  clock += std::max(seconds, kLeast_s) * std::exp2(-priority);
  if (ready) ready_.insert({clock, job});
}

void FairShare::Reprioritize(std::uint64_t job, int before, int priority) {
  const auto it = clocks_.find(job);
  if (it == clocks_.end() || it->second <= now_ || priority <= before) return;
  const bool ready = ready_.erase({it->second, job}) > 0;
  it->second = now_ + (it->second - now_) * std::exp2(before - priority);
  if (ready) ready_.insert({it->second, job});
}

}  // namespace cairn::coordinator
