#include "tests/simulation/faults.h"

namespace cairn::simulation {
namespace {

// A world knows each kind of trouble with this probability.
constexpr double kKnown = 0.35;

// Draws how much a world has of a kind of trouble: none, or up to `high`.
auto Maybe(Rng& rng) {
  return [&rng](double high) { return rng.Uniform() < kKnown ? rng.Uniform(0, high) : 0.0; };
}

void DrawWorkers(Faults& f, Rng& rng) {
  const auto maybe = Maybe(rng);
  f.crash_per_s = maybe(0.08);
  f.hang_per_s = maybe(0.03);
  f.stop_per_s = maybe(0.03);
  f.leave_per_s = maybe(0.05);
  f.drain_per_s = maybe(0.05);
  f.terminate_per_s = maybe(0.05);
  f.clock_jump_per_s = maybe(0.05);
  f.crash_at_message = maybe(0.02);
  f.task_crash = maybe(0.05);
  f.slow = maybe(0.5);
  f.other_build = maybe(0.5);
  f.late_joiners_per_s = maybe(0.1);
  if (rng.Below(5) == 0) {
    f.liars = rng.Uniform(0.1, 0.7);
    f.lie = rng.Uniform(0.05, 0.5);
    f.plausible_lies = rng.Below(2) == 0;
  }
  f.tell_deaths = rng.Below(2) == 0;
}

void DrawCoordinator(Faults& f, Rng& rng) {
  const auto maybe = Maybe(rng);
  f.coordinator_crash_per_s = maybe(0.15);
  f.coordinator_stop_per_s = maybe(0.05);
  f.coordinator_clock_jump_per_s = maybe(0.05);
  f.crash_at_action = maybe(0.01);
  f.power_cut = rng.Below(2) == 0 ? rng.Uniform() : 0.0;
  f.disk_full_per_s = maybe(0.1);
  f.sync_fails = maybe(0.1);
  f.damaged = maybe(1);
  f.persist_s = rng.Uniform(0.001, 2);
}

void DrawJobs(Faults& f, Rng& rng) {
  const auto maybe = Maybe(rng);
  f.cancel_per_s = maybe(0.02);
  f.pause_per_s = maybe(0.1);
  f.prioritize_per_s = maybe(0.1);
  f.delete_per_s = maybe(0.05);
  f.workers = 1 + static_cast<int>(rng.Below(5));
  f.jobs = 1 + static_cast<int>(rng.Below(3));
  f.stages = 1 + static_cast<int>(rng.Below(3));
  f.rounds = 1 + static_cast<int>(rng.Below(8));
  f.tasks = 1 + static_cast<int>(rng.Below(9));
  f.bad_input = rng.Below(5) == 0;
  f.poisoned = rng.Below(10) == 0;
  f.hopeless = rng.Below(10) == 0;
  f.task_s = rng.Uniform(0.01, 0.5);
}

// What is left of the others blames no task.
void DrawNight(Faults& f, Rng& rng) {
  f.night = true;
  f.hang_per_s = f.stop_per_s = f.crash_at_message = f.task_crash = f.break_per_s = f.liars = 0;
  f.coordinator_clock_jump_per_s = 0;
  f.tell_deaths = false;
  f.crash_per_s = rng.Uniform(0.1, 0.4);
  f.late_joiners_per_s = 1;
}

}  // namespace

Faults DrawFaults(std::uint64_t seed) {
  Rng rng(seed, 1);
  Faults f;
  const auto maybe = Maybe(rng);
  f.lose = maybe(0.15);
  f.duplicate = maybe(0.3);
  f.delay_s = rng.Uniform(0.0005, 0.05);
  f.late = maybe(0.1);
  f.partition_per_s = maybe(0.05);
  DrawWorkers(f, rng);
  DrawCoordinator(f, rng);
  DrawJobs(f, rng);
  f.core.build.set_version("1");
  f.core.lease_s = rng.Uniform(3, 6);
  f.core.unlisted_s = rng.Uniform(2, 3);
  f.core.hung_s = rng.Uniform(6, 12);
  f.core.plan_hung_s = rng.Uniform(12, 20);
  f.core.straggler_min_s = rng.Uniform(0, 1);
  f.core.checkpoint_interval_s = rng.Below(4) == 0 ? 0 : rng.Uniform(0.1, 2);
  f.power_cut_at_start = maybe(0.5);
  f.embedded = rng.Below(4) == 0;
  f.upload_killed = maybe(0.5);
  f.upload_stops = maybe(0.1);
  f.upload_cheats = maybe(0.5);
  f.break_per_s = maybe(0.1);
  if (rng.Below(10) == 0) DrawNight(f, rng);
  f.blob_damage = maybe(0.3);
  return f;
}

}  // namespace cairn::simulation
