// Which task goes to which worker. Nothing here may change a result, only when it is there.
#include <algorithm>

#include "coordinator/core/core.h"

namespace cairn::coordinator {
namespace {

constexpr std::size_t kTasksLookedAt = 64;

}  // namespace

void Core::Dispatch() {
  for (const std::uint64_t order : touched_) Queue(order);
  do {
    DispatchReady();
  } while (MoveQueued());  // what makes room behind whom it is taken from
  if (workers_due_) CopyStragglers();
}

void Core::DispatchReady() {
  std::vector<std::uint64_t> without;  // jobs whose task only workers could get that they exclude
  while (fleet_.AnyRoom()) {
    const std::optional<std::uint64_t> order = share_.Next();
    if (!order) break;
    Job& job = jobs_.at(*order);
    const auto [first, worker] = Place(job);
    if (worker == nullptr) {
      share_.Withdraw(*order);
      without.push_back(*order);
      continue;
    }
    const std::uint32_t task =
        job.tasks.task(first).parts.empty() ? first : NearestReady(job, *worker).value_or(first);
    const std::vector<Hash> inputs = TaskInputs(job, task);
    Assign(job, task, inputs, *worker);
    share_.Charge(*order, job.ExpectedSeconds(task), job.spec.priority());
    Queue(*order);
  }
  for (const std::uint64_t order : without) Queue(order);
}

// The first task that is ready, and who gets it; where all that have room have failed it, the next one.
std::pair<std::uint32_t, Worker*> Core::Place(const Job& job) {
  const std::uint32_t first = job.tasks.NextReady();
  Worker* worker = fleet_.Place(TaskInputs(job, first), ExcludedBy(job, first));
  if (worker != nullptr || job.tasks.task(first).failed_at.empty()) return {first, worker};
  for (const std::uint32_t task : job.tasks.FirstReady(kTasksLookedAt))
    if (worker = fleet_.Place(TaskInputs(job, task), ExcludedBy(job, task)); worker != nullptr)
      return {task, worker};
  return {first, nullptr};
}

// Of the first tasks that are ready, the one of whose parts of blobs the worker has
// most, and others fewest: a log that is cut in two goes over the wire once, not twice.
std::optional<std::uint32_t> Core::NearestReady(const Job& job, const Worker& worker) const {
  std::optional<std::uint32_t> nearest;
  std::ptrdiff_t most = 0;
  for (const std::uint32_t task : job.tasks.FirstReady(kTasksLookedAt)) {
    if (ExcludedBy(job, task).contains(worker.number)) continue;
    std::ptrdiff_t has = 0;
    for (const Hash& part : job.tasks.task(task).parts) {
      const std::uint64_t owner = job.parts.WorkerOf(part);
      if (owner == worker.number)
        ++has;
      else if (fleet_.workers().contains(owner))
        --has;
    }
    if (!nearest || has > most) nearest = task, most = has;
  }
  return nearest;
}

bool Core::MayServe(const Worker& worker, const Job& job) const {
  return NearestReady(job, worker).has_value();
}

// A job that has nobody else must end too, by the failures of whom it has.
const std::set<std::uint64_t>& Core::ExcludedBy(const Job& job) const {
  static const std::set<std::uint64_t> kNobody;
  return AreAll(job.excluded) ? kNobody : job.excluded;
}

std::set<std::uint64_t> Core::ExcludedBy(const Job& job, std::uint32_t task) const {
  std::set<std::uint64_t> excluded = ExcludedBy(job);
  const std::vector<std::uint64_t>& failed_at = job.tasks.task(task).failed_at;
  if (failed_at.empty()) return excluded;
  excluded.insert(failed_at.begin(), failed_at.end());
  return AreAll(excluded) ? ExcludedBy(job) : excluded;
}

bool Core::AreAll(const std::set<std::uint64_t>& workers) const {
  std::size_t able = 0;
  for (const std::uint64_t number : workers)
    if (const auto it = fleet_.workers().find(number); it != fleet_.workers().end())
      able += it->second.Able();
  return able >= fleet_.able();
}

// Whether a job has a task to give may have changed.
void Core::Queue(std::uint64_t order) {
  const auto it = jobs_.find(order);
  if (it == jobs_.end()) return share_.Forget(order);
  if (it->second.Running() && it->second.tasks.HasReady())
    share_.Offer(order);
  else
    share_.Withdraw(order);
}

void Core::Assign(Job& job, std::uint32_t task, const std::vector<Hash>& inputs, Worker& worker) {
  const std::uint32_t attempt = job.tasks.Begin(task, worker.number);
  for (const Hash& input : inputs) fleet_.NoteBlob(worker, input);
  for (const Hash& part : job.tasks.task(task).parts) job.parts.Note(part, worker.number);
  fleet_.Give(worker, job.Key(task, attempt), now_s_);
  job.NoteGiven(job.Key(task, attempt), worker.peer);
  Send send{worker.peer, {}};
  wire::Assign& assign = *send.message.mutable_assign();
  assign = MakeAssign(job, task, attempt);
  if (assign.memory_mb() == 0) assign.set_memory_mb(options_.task_memory_mb);
  actions_.push_back(std::move(send));
}

void Core::Withdraw(Job& job, std::uint32_t task, const Attempt& attempt) {
  job.tasks.Withdraw(task, attempt.number);
  Worker* worker = fleet_.Find(attempt.worker);
  if (worker != nullptr) CallBack(*worker, job.Key(task, attempt.number));
}

void Core::CallBack(Worker& worker, const wire::TaskKey& key) {
  if (!fleet_.Take(worker, key, now_s_)) return;
  Send send{worker.peer, {}};
  *send.message.mutable_cancel()->mutable_key() = key;
  actions_.push_back(std::move(send));
}

void Core::WithdrawOthers(Job& job, std::uint32_t task) {
  for (const Attempt& attempt : std::vector(job.tasks.task(task).live_attempts)) Withdraw(job, task, attempt);
}

void Core::WithdrawAll(Job& job) {
  for (std::uint32_t task = 0; task < job.tasks.size(); ++task) WithdrawOthers(job, task);
}

// A task that `worker` has assigned goes back to those that are ready, nobody to blame.
Job* Core::Reclaim(Worker& worker, const wire::TaskKey& key) {
  CallBack(worker, key);
  Job* job = JobOf(key);
  if (job == nullptr || !job->tasks.Withdraw(key.task(), key.attempt())) return nullptr;
  return job;
}

Job* Core::JobOf(const wire::TaskKey& key) {
  Job* job = FindById(key.job());
  return job != nullptr && job->IsUnderWay(key) ? job : nullptr;
}

// Deep queues keep short tasks flowing; where they are long, an idle worker takes over what waits behind
// another. Not by what may have been answered long ago.
bool Core::MoveQueued() {
  Worker* busiest = behind_ || fleet_.Idle() == nullptr ? nullptr : fleet_.Busiest();
  if (busiest == nullptr) return false;
  const wire::TaskKey key = busiest->assigned.back().key;
  const Job* running = JobOf(key);
  if (running == nullptr || !running->Running()) return false;
  Worker* idle = fleet_.Idle(ExcludedBy(*running, key.task()));
  if (idle == nullptr) return false;
  Job* job = Reclaim(*busiest, key);
  if (job != nullptr && job->tasks.task(key.task()).status == TaskStatus::kReady)
    Assign(*job, key.task(), TaskInputs(*job, key.task()), *idle);
  return true;
}

// Those that run for far longer than the others of their round did, the longest first; each has one copy.
void Core::CopyStragglers() {
  if (fleet_.Idle() == nullptr) return;
  std::map<std::string, double> medians_s;  // by job
  std::vector<std::pair<double, wire::TaskKey>> stragglers;
  for (const auto& [number, worker] : fleet_.workers()) {
    const double runs_s = caught_up_s_ - worker.head_s;
    if (worker.assigned.empty() || runs_s < options_.straggler_min_s) continue;
    const wire::TaskKey& key = worker.assigned.front().key;
    const Job* job = key.kind() == wire::TaskKey::RUN ? JobOf(key) : nullptr;
    if (job == nullptr || !job->Running() || job->tasks.task(key.task()).live_attempts.size() != 1) continue;
    const auto [median_s, is_new] = medians_s.try_emplace(key.job());
    if (is_new) median_s->second = job->MedianTaskSeconds();
    if (median_s->second > 0 && runs_s >= options_.straggler_factor * median_s->second)
      stragglers.emplace_back(runs_s, key);
  }
  std::stable_sort(stragglers.begin(), stragglers.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  for (const auto& [runs_s, key] : stragglers) {
    Job& job = *JobOf(key);
    Worker* idle = fleet_.Idle(ExcludedBy(job, key.task()));
    if (idle == nullptr) continue;
    Assign(job, key.task(), TaskInputs(job, key.task()), *idle);
  }
}

}  // namespace cairn::coordinator
