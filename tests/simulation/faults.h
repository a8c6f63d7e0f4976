// What may go wrong in one simulated world, and how often: drawn from the seed, so that some worlds know one
// kind of trouble only and others all of them.
#pragma once

#include <cstdint>

#include "coordinator/core.h"
#include "schema/rng.h"

namespace cairn::simulation {

struct Faults {
  double trouble_s = 40;  // then everything heals, and all jobs must end
  // Network, a message each.
  double lose = 0, duplicate = 0, delay_s = 0.01, late = 0;  // `late`: fraction that comes seconds later
  double partition_per_s = 0;
  // Workers, each.
  double crash_per_s = 0, hang_per_s = 0, leave_per_s = 0;
  double task_crash = 0;   // fraction of tasks that end in a failure
  double slow = 0;         // fraction of workers that are 20 times slower
  double other_build = 0;  // fraction of joiners that are of another build
  double late_joiners_per_s = 0;
  bool tell_deaths = false;  // the shell sees a worker die before its lease is over
  // Coordinator and its disk.
  double coordinator_crash_per_s = 0, disk_full = 0, checkpoint_damaged = 0;
  double persist_s = 0.02;
  // Users.
  double cancel_per_s = 0;

  int workers = 3, jobs = 1, stages = 1, rounds = 5, tasks = 6;
  bool bad_input = false;  // one more job, whose input is bad
  double task_s = 0.1;
  coordinator::CoreOptions core;
};

Faults DrawFaults(std::uint64_t seed);

}  // namespace cairn::simulation
