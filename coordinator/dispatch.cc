// Which task goes to which worker. Nothing here may change a result, only when it is there.
#include "coordinator/core.h"

namespace cairn::coordinator {

void Core::Dispatch() {
  while (fleet_.AnyRoom()) {
    Job* job = NextJob();
    if (job == nullptr) break;
    const std::uint32_t task = job->tasks.NextReady();
    Assign(*job, task, *fleet_.Place(TaskInputs(*job, task)));
  }
  for (auto& [number, worker] : fleet_.workers()) {
    if (!worker.Idle()) continue;
    if (!MoveQueuedTo(worker) && !CopyStragglerTo(worker))
      break;  // nothing for this one, nothing for the next
  }
}

// Jobs take turns, a task each. Priorities would come in here.
Job* Core::NextJob() {
  Job* first = nullptr;
  for (auto& [order, job] : jobs_) {
    if (!job.Running() || !job.tasks.HasReady()) continue;
    if (order > served_order_) {
      served_order_ = order;
      return &job;
    }
    if (first == nullptr) first = &job;
  }
  if (first != nullptr) served_order_ = first->order;
  return first;
}

void Core::Assign(Job& job, std::uint32_t task, Worker& worker) {
  const std::uint32_t attempt = job.tasks.Begin(task);
  for (const Hash& input : TaskInputs(job, task)) worker.has.insert(input);
  worker.Give(job.Key(task, attempt), now_s_);
  job.NoteGiven(job.Key(task, attempt), worker.peer);
  Send send{worker.peer, {}};
  *send.message.mutable_assign() = MakeAssign(job, task, attempt);
  actions_.push_back(std::move(send));
}

void Core::Withdraw(Job& job, std::uint32_t task, std::uint32_t attempt) {
  const wire::TaskKey key = job.Key(task, attempt);
  job.tasks.Withdraw(task, attempt);
  for (auto& [number, worker] : fleet_.workers()) {
    if (!worker.Take(key, now_s_)) continue;
    Send send{worker.peer, {}};
    *send.message.mutable_cancel()->mutable_key() = key;
    actions_.push_back(std::move(send));
  }
}

void Core::WithdrawOthers(Job& job, std::uint32_t task) {
  for (const std::uint32_t attempt : std::vector(job.tasks.task(task).live_attempts))
    Withdraw(job, task, attempt);
}

void Core::WithdrawAll(Job& job) {
  for (std::uint32_t task = 0; task < job.tasks.size(); ++task) WithdrawOthers(job, task);
}

Job* Core::JobOf(const wire::TaskKey& key) {
  Job* job = FindById(key.job());
  const bool open = job != nullptr && !job->Ended() && key.stage() == job->stage &&
                    key.round() == job->round && key.kind() == job->tasks.kind() &&
                    key.task() < job->tasks.size();
  return open ? job : nullptr;
}

// Deep queues keep short tasks flowing; where they are long, an idle worker takes over what waits behind
// another.
bool Core::MoveQueuedTo(Worker& idle) {
  Worker* longest = nullptr;
  for (auto& [number, worker] : fleet_.workers())
    if (worker.in_hand.size() >= 2 && (longest == nullptr || worker.in_hand.size() > longest->in_hand.size()))
      longest = &worker;
  if (longest == nullptr) return false;
  const wire::TaskKey key = longest->in_hand.back().key;
  Job* job = JobOf(key);
  if (job == nullptr || !job->Running()) return false;
  Withdraw(*job, key.task(), key.attempt());
  if (job->tasks.task(key.task()).status == TaskStatus::kReady) Assign(*job, key.task(), idle);
  return true;
}

bool Core::CopyStragglerTo(Worker& idle) {
  Job* slowest = nullptr;
  std::uint32_t task = 0;
  double longest_s = options_.straggler_min_s;
  for (const auto& [number, worker] : fleet_.workers()) {
    if (worker.in_hand.empty()) continue;
    const wire::TaskKey& key = worker.in_hand.front().key;
    Job* job = key.kind() == wire::TaskKey::RUN ? JobOf(key) : nullptr;
    if (job == nullptr || !job->Running() || job->tasks.task(key.task()).live_attempts.size() != 1) continue;
    const double median_s = job->MedianTaskSeconds();
    const double runs_s = now_s_ - worker.head_s;
    if (median_s <= 0 || runs_s < options_.straggler_factor * median_s || runs_s < longest_s) continue;
    slowest = job;
    task = key.task();
    longest_s = runs_s;
  }
  if (slowest == nullptr) return false;
  Assign(*slowest, task, idle);
  return true;
}

}  // namespace cairn::coordinator
