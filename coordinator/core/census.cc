#include "coordinator/core/census.h"

#include "coordinator/core/core.h"

namespace cairn::coordinator {

// A job costs the same, however many tasks it has.
Census Core::TakeCensus() const {
  Census census;
  for (const char* state : {"queued", "running", "paused", "done", "failed", "cancelled"}) census.jobs[state];
  for (const char* state : {"idle", "busy", "hung", "draining"}) census.workers[state];
  for (const auto& [order, job] : jobs_) {
    ++census.jobs[StateName(job)];
    if (!job.Running()) continue;
    const Round::Share running = job.tasks.share(TaskStatus::kRunning);
    const Round::Share ready = job.tasks.share(TaskStatus::kReady);
    const Round::Share waiting = job.tasks.share(TaskStatus::kWaiting);
    census.tasks_running += running.tasks;
    census.tasks_waiting += ready.tasks + waiting.tasks;
    census.waiting_work_s += job.ExpectedSeconds(ready) + job.ExpectedSeconds(waiting);
  }
  for (const auto& [number, worker] : fleet_.workers()) ++census.workers[StateName(worker)];
  return census;
}

}  // namespace cairn::coordinator
