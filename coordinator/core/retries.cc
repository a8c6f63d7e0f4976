// When a task has failed: it is tried again, by another worker where there is one, until it has failed so
// often that the job fails (CoreOptions::max_failures).
#include <algorithm>

#include "coordinator/core/core.h"
#include "schema/error.h"

namespace cairn::coordinator {
namespace {

constexpr std::size_t kFailuresKept = 20;  // of a job, for people

}  // namespace

void Core::On(const TaskFailed& event) {
  Worker* worker = Heard(event.peer);
  if (worker == nullptr) return;
  const wire::TaskKey& key = event.failed.key();
  fleet_.SetHung(*worker, false);
  worker->moved_s = now_s_;
  // Numbers of attempts begin again after a restart: only what this worker was given here counts.
  if (!fleet_.Take(*worker, key, now_s_)) return RefuseAnswer(*worker, key);
  Job* job = JobOf(key);
  if (job == nullptr || !job->tasks.Withdraw(key.task(), key.attempt())) return;
  if (event.failed.input_error())
    return FailJob(*job, job->TaskName(key.task()) + ": " + event.failed.message(), true);
  FailAttempt(*job, key.task(), event.failed.message());
}

// Its transport checks what it carries: whoever sends a malformed answer is broken, or computes what is. In
// the first case one worker alone must not use up a task's attempts; in the second others come to the same.
void Core::Exclude(Job& job, const wire::TaskKey& key, Worker& worker, const std::string& wrong) {
  if (!job.tasks.Withdraw(key.task(), key.attempt())) return;
  const std::string who = WorkerName(worker.hello);
  std::erase_if(job.excluded, [this](std::uint64_t number) { return fleet_.Find(number) == nullptr; });
  if (job.excluded.insert(worker.number).second)
    Say(Report::kWarning, who + " gets no more tasks of " + job.id + " where there are others: " + wrong);
  std::vector<wire::TaskKey> queued;
  for (const AssignedTask& task : worker.assigned)
    if (task.key.job() == job.id) queued.push_back(task.key);
  for (const wire::TaskKey& other : queued) Reclaim(worker, other);
  FailAttempt(job, key.task(), wrong + ", by " + who);
}

std::string CutReason(const std::string& reason) {
  constexpr std::size_t kMost = 4096;
  return reason.size() <= kMost ? reason : reason.substr(0, kMost) + " …";
}

void Core::FailAttempt(Job& job, std::uint32_t task, const std::string& whole_reason) {
  const std::string why = CutReason(whole_reason);
  if (job.Ended() || job.tasks.task(task).status == TaskStatus::kDone) return;
  const std::string name = job.TaskName(task);
  const int failures = job.tasks.Blame(task);
  job.failures.push_back(name + ": " + why);
  if (job.failures.size() > kFailuresKept) job.failures.erase(job.failures.begin());
  job.facts.back().set_retries(job.facts.back().retries() + 1);
  ++tally_.retries;
  if (failures >= options_.max_failures)
    return FailJob(job, name + " failed " + std::to_string(failures) + " times, last: " + why, false);
  Say(Report::kWarning, job, name + ": " + why + "; it is tried again");
}

void Core::NoteLost(const Worker& worker) {
  if (worker.assigned.empty() || worker.hello.process() == 0) return;
  const wire::TaskKey& key = worker.assigned.front().key;
  const Job* job = JobOf(key);
  if (job == nullptr) return;
  const std::vector<Attempt>& live = job->tasks.task(key.task()).live_attempts;
  if (std::ranges::any_of(live, [&key](const Attempt& attempt) { return attempt.number == key.attempt(); }))
    lost_[worker.hello.process()] = {key, now_s_};
}

// A task that ends its worker's process never comes here: the next process is another.
void Core::TakeBackBlame(const wire::Hello& hello) {
  const auto lost = lost_.extract(hello.process());
  if (lost.empty() || now_s_ - lost.mapped().since_s > options_.back_s) return;
  const wire::TaskKey& key = lost.mapped().key;
  Job* job = JobOf(key);
  if (job == nullptr || job->Ended() || !job->tasks.TakeBack(key.task())) return;
  Say(Report::kInfo, *job,
      job->TaskName(key.task()) + ": " + WorkerName(hello) +
          " is back; that it was lost counts as no failure of the task");
}

bool Core::Excuse(const Worker& worker) {
  if (worker.assigned.empty()) return true;
  const wire::TaskKey& key = worker.assigned.front().key;
  Job* job = JobOf(key);
  return job == nullptr || job->tasks.Excuse(key.task());
}

}  // namespace cairn::coordinator
