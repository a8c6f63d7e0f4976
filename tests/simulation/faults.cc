#include "tests/simulation/faults.h"

namespace cairn::simulation {

Faults DrawFaults(std::uint64_t seed) {
  Rng rng(seed, 1);
  Faults f;
  const auto maybe = [&rng](double high) { return rng.Uniform() < 0.4 ? rng.Uniform(0, high) : 0.0; };
  f.lose = maybe(0.15);
  f.duplicate = maybe(0.3);
  f.delay_s = rng.Uniform(0.0005, 0.05);
  f.late = maybe(0.1);
  f.partition_per_s = maybe(0.05);
  f.crash_per_s = maybe(0.08);
  f.hang_per_s = maybe(0.03);
  f.leave_per_s = maybe(0.05);
  f.task_crash = maybe(0.05);
  f.slow = maybe(0.5);
  f.other_build = maybe(0.5);
  f.late_joiners_per_s = maybe(0.1);
  f.tell_deaths = rng.Below(2) == 0;
  f.coordinator_crash_per_s = maybe(0.15);
  f.disk_full = maybe(0.2);
  f.checkpoint_damaged = maybe(1);
  f.persist_s = rng.Uniform(0.001, 2);
  f.cancel_per_s = maybe(0.05);
  f.workers = 1 + static_cast<int>(rng.Below(5));
  f.jobs = 1 + static_cast<int>(rng.Below(3));
  f.stages = 1 + static_cast<int>(rng.Below(3));
  f.rounds = 1 + static_cast<int>(rng.Below(8));
  f.tasks = 1 + static_cast<int>(rng.Below(9));
  f.bad_input = rng.Below(5) == 0;
  f.task_s = rng.Uniform(0.01, 0.5);
  f.core.lease_s = rng.Uniform(3, 6);
  f.core.unlisted_s = rng.Uniform(2, 3);
  f.core.hung_s = rng.Uniform(6, 12);
  f.core.plan_hung_s = rng.Uniform(12, 20);
  f.core.straggler_min_s = rng.Uniform(0, 1);
  f.core.checkpoint_interval_s = rng.Below(4) == 0 ? 0 : rng.Uniform(0.1, 2);
  return f;
}

}  // namespace cairn::simulation
