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
  ++worker->failures;
  if (event.failed.input_error())
    return FailJob(*job, job->TaskName(key.task()) + ": " + event.failed.message(), true);
  FailAttempt(*job, key.task(), worker->number, event.failed.message());
}

// Its transport checks what it carries: whoever sends a malformed answer is broken, or computes what is. In
// the first case one worker alone must not use up a task's attempts; in the second others come to the same.
void Core::Exclude(Job& job, const wire::TaskKey& key, Worker& worker, const std::string& wrong) {
  if (!job.tasks.Withdraw(key.task(), key.attempt())) return;
  ++worker.failures;
  const std::string who = WorkerName(worker.hello);
  std::erase_if(job.excluded, [this](std::uint64_t number) { return fleet_.Find(number) == nullptr; });
  if (job.excluded.insert(worker.number).second)
    Say(Report::kWarning, who + " gets no more tasks of " + job.id + " where there are others: " + wrong);
  std::vector<wire::TaskKey> queued;
  for (const AssignedTask& task : worker.assigned)
    if (task.key.job() == job.id) queued.push_back(task.key);
  for (const wire::TaskKey& other : queued) Reclaim(worker, other);
  FailAttempt(job, key.task(), worker.number, wrong + ", by " + who);
}

std::string CutReason(const std::string& reason) {
  constexpr std::size_t kMost = 4096;
  return reason.size() <= kMost ? reason : reason.substr(0, kMost) + " …";
}

void Core::FailAttempt(Job& job, std::uint32_t task, std::uint64_t worker, const std::string& whole_reason) {
  const std::string why = CutReason(whole_reason);
  if (job.Ended() || job.tasks.task(task).status == TaskStatus::kDone) return;
  const std::string name = job.TaskName(task);
  const int failures = job.tasks.Blame(task, worker);
  job.failures.push_back(name + ": " + why);
  if (job.failures.size() > kFailuresKept) job.failures.erase(job.failures.begin());
  job.facts.back().set_retries(job.facts.back().retries() + 1);
  ++tally_.retries;
  if (failures >= options_.max_failures)
    return FailJob(job, name + " failed " + std::to_string(failures) + " times, last: " + why, false);
  Say(Report::kWarning, job, name + ": " + why + "; it is tried again");
}

// Null where that is not under way any more.
Job* Core::JobOfRunning(const Worker& worker) {
  if (worker.assigned.empty()) return nullptr;
  const wire::TaskKey& key = worker.assigned.front().key;
  Job* job = JobOf(key);
  if (job == nullptr) return nullptr;
  const std::vector<Attempt>& live = job->tasks.task(key.task()).live_attempts;
  const bool is_live =
      std::ranges::any_of(live, [&key](const Attempt& attempt) { return attempt.number == key.attempt(); });
  return is_live ? job : nullptr;
}

void Core::NoteLost(const Worker& worker) {
  if (worker.hello.process() != 0 && JobOfRunning(worker) != nullptr)
    lost_[worker.hello.process()] = {worker.assigned.front().key, now_s_};
}

// A process that its task ends closes its connection, which is seen at once. Silence is a machine's, or a
// network's, that is gone: many of those in one night say nothing of the task. One that takes its machine
// along each time is found out all the same.
bool Core::LoseWithNode(const Worker& worker) {
  Job* job = JobOfRunning(worker);
  if (job == nullptr) return true;
  const std::uint32_t task = worker.assigned.front().key.task();
  if (!job->tasks.Excuse(task)) return false;
  job->facts.back().set_lost(job->facts.back().lost() + 1);
  ++tally_.lost;
  Say(Report::kInfo, *job,
      job->TaskName(task) + " is lost with " + WorkerName(worker.hello) +
          ", which counts as no failure of the task; it is tried again");
  return true;
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
