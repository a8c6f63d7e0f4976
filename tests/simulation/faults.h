// What may go wrong in one simulated world, and how often: drawn from the seed, so that some worlds know one
// kind of trouble only and others all of them.
#pragma once

#include <cstdint>

#include "coordinator/core/core.h"
#include "schema/rng.h"

namespace cairn::simulation {

struct Faults {
  double trouble_s = 40;  // then everything heals, and all jobs must end
  // Network, a message each.
  double lose = 0, duplicate = 0, delay_s = 0.01, late = 0;  // `late`: fraction that comes seconds later
  double blob_damage = 0;                                    // of what workers fetch
  double partition_per_s = 0;                                // of a worker; some in one direction only
  // Workers, each.
  double crash_per_s = 0, hang_per_s = 0, stop_per_s = 0, leave_per_s = 0, clock_jump_per_s = 0;
  double drain_per_s = 0, terminate_per_s = 0;  // told to drain by a user; by its machine
  double crash_at_message = 0;  // fraction of messages and of answers that it does not outlive
  double task_crash = 0;        // fraction of tasks that end in a failure
  double slow = 0;              // fraction of workers that are 20 times slower
  double other_build = 0;       // fraction of joiners that are of another build
  double late_joiners_per_s = 0;
  double liars = 0, lie = 0;    // fraction of workers that lie, and of their answers that are lies
  bool plausible_lies = false;  // theirs may be of the right shape too
  double break_per_s = 0;       // its connection breaks, and it comes back
  bool night = false;           // one machine after the other is gone, and nothing else is wrong with workers
  bool tell_deaths = false;     // the shell sees a worker die before its lease is over
  // The coordinator's process and machine.
  double coordinator_crash_per_s = 0, coordinator_stop_per_s = 0, coordinator_clock_jump_per_s = 0;
  double crash_at_action = 0;  // fraction of the core's actions that the process does not live to carry out
  double power_cut = 0;        // fraction of its crashes in which the machine goes too
  double power_cut_at_start = 0;  // fraction of its starts after which the machine goes within a second
  // Its disk.
  double disk_full_per_s = 0;  // for some seconds
  double sync_fails = 0;       // fraction of fsyncs
  double damaged = 0;       // fraction of restarts that find the newest checkpoint, or a blob of it, damaged
  double persist_s = 0.02;  // a checkpoint takes at most this long
  // Users.
  double cancel_per_s = 0, pause_per_s = 0, prioritize_per_s = 0, delete_per_s = 0;  // a job each

  bool embedded = false;  // jobs are of the coordinator's own process, which has their inputs
  // Else: clients that bring inputs in pieces.
  double upload_killed = 0, upload_stops = 0,
         upload_cheats = 0;  // fraction of them; `stops` of what they hear

  int workers = 3, jobs = 1, stages = 1, rounds = 5, tasks = 6;
  bool bad_input = false;  // one more job, whose input is bad
  bool poisoned = false;   // one more job, one of whose tasks always fails
  bool hopeless = false;   // one more job, whose chain of stages cannot be
  double task_s = 0.1;
  coordinator::CoreOptions core;
};

Faults DrawFaults(std::uint64_t seed);

}  // namespace cairn::simulation
