// The core's tables, as anybody may look at them.
#include <algorithm>
#include <cmath>

#include "tests/simulation/checks.h"
#include "tests/simulation/world.h"

namespace cairn::simulation {

using namespace coordinator;  // NOLINT: events and actions, all over this file

namespace {

constexpr std::size_t kMostFailures = 20;   // that a job keeps the text of
constexpr std::size_t kMostExcluded = 100;  // more than there are workers at a time
constexpr std::uint64_t kLookCloser = 16;   // every so many events
constexpr double kLeastTurn_s = 1e-3;       // no turn is free

bool IsUnderWay(const Job* job, const wire::TaskKey& key) {
  if (job == nullptr || job->Ended() || key.stage() != job->stage || key.round() != job->round ||
      key.kind() != job->tasks.kind() || key.task() >= job->tasks.size())
    return false;
  const auto& live = job->tasks.task(key.task()).live_attempts;
  return std::any_of(live.begin(), live.end(),
                     [&key](const Attempt& attempt) { return attempt.number == key.attempt(); });
}

}  // namespace

// What a worker is assigned is under way, and what is under way some worker is assigned.
void Checks::SeeTables(const Core& core, bool ticked, double now_s) {
  std::map<std::string, std::size_t> held, live;
  for (const auto& [number, worker] : core.fleet().workers()) {
    if (worker.assigned.size() > worker.hello.slots()) Fail(worker.peer + " has more tasks than slots");
    for (const AssignedTask& task : worker.assigned) {
      if (!IsUnderWay(core.FindJob(task.key.job()), task.key))
        Fail(worker.peer + " is assigned a task that nobody waits for");
      ++held[task.key.job()];
    }
    if (ticked && now_s - worker.heard_s > world_.faults.core.lease_s)
      Fail(worker.peer + " is silent, and still counted as there");
    if (worker.has.size() > core.held_blobs()) Fail("the blobs that " + worker.peer + " may have grow");
    if (events_ % kLookCloser == 0)
      for (const Hash& blob : worker.has)
        if (!core.Holds(blob)) Fail("a blob that nobody needs is known to be with " + worker.peer);
  }
  for (const auto& [id, known] : jobs_) {
    const Job* job = core.FindJob(id);
    if (job == nullptr) continue;
    for (std::uint32_t i = 0; i < job->tasks.size(); ++i) {
      const TaskRecord& task = job->tasks.task(i);
      live[id] += task.live_attempts.size();
      if ((task.status == TaskStatus::kRunning) == task.live_attempts.empty())
        Fail("task " + std::to_string(i) + " of " + id + " is not where it says");
    }
    if (live[id] != held[id]) Fail("a task of " + id + " runs that no worker has");
    const bool room = std::any_of(
        core.fleet().workers().begin(), core.fleet().workers().end(),
        [&](const auto& entry) { return entry.second.HasRoom() && core.MayServe(entry.second, *job); });
    if (room && job->Running()) Fail("a worker has room and " + id + " a task that is ready");
    SeeJobTables(*job);
  }
  ++events_;
}

// What a worker's heartbeat does not list, though it was given long ago, never arrived: it goes elsewhere.
void Checks::SeeHeartbeat(const Core& core, const WorkerHeartbeat& event, double now_s) {
  for (const auto& [number, worker] : core.fleet().workers()) {
    if (worker.peer != event.peer) continue;
    for (const AssignedTask& task : worker.assigned) {
      const auto& listed = event.heartbeat.tasks();
      const bool is_listed = std::any_of(listed.begin(), listed.end(), [&task](const wire::TaskKey& key) {
        return SameAttempt(key, task.key);
      });
      if (!is_listed && now_s - task.since_s > world_.faults.core.unlisted_s)
        Fail("a task that never came to " + worker.peer + " is still left to it");
    }
  }
}

void Checks::SeeJobTables(const Job& job) {
  const Known& known = jobs_.at(job.id);
  if (job.failures.size() > kMostFailures) Fail(job.id + "'s failures grow");
  if (job.task_seconds.size() > job.partials.size()) Fail(job.id + "'s task times grow");
  if (job.excluded.size() > kMostExcluded) Fail(job.id + " excludes ever more workers");
  if (job.saving.unpublished.size() > known.stages) Fail(job.id + "'s results to publish grow");
  if (job.facts.size() > known.stages) Fail(job.id + "'s facts grow");
  if (known.deceived || events_ % kLookCloser != 0) return;
  for (std::uint32_t stage = 0; stage < job.facts.size(); ++stage) {
    const auto first = known.truth.rounds.lower_bound({stage, 0});
    const auto last = known.truth.rounds.lower_bound({stage + 1, 0});
    if (job.facts[stage].rounds_size() > std::distance(first, last) + 1)
      Fail(job.id + " counts rounds that it did not run");
  }
}

// Nothing starves: what others were given while a job had a task to dispatch is bounded. All are weighed by
// the seconds that their tasks are expected to take, divided by the job's share, 2^priority: whoever is
// served goes ahead by one task of its own, so that each other may get that much and one task more.
void Checks::SeeTurns(const Core& core, const std::vector<Action>& actions) {
  std::map<std::string, double> given;
  std::vector<std::pair<std::string, double>> turns;  // of all jobs, with their workers
  for (const Action& action : actions) {
    const auto* send = std::get_if<Send>(&action);
    if (send == nullptr || !send->message.has_assign()) continue;
    const wire::TaskKey& key = send->message.assign().key();
    const Job* job = core.FindJob(key.job());
    if (!IsUnderWay(job, key)) return;  // told of elsewhere
    const double turn =
        std::max(job->ExpectedSeconds(key.task()), kLeastTurn_s) * std::exp2(-job->spec.priority());
    given[key.job()] += turn;
    turns.emplace_back(send->peer, turn);
    Known& known = jobs_.at(key.job());
    known.largest_turn = std::max(known.largest_turn, turn);
  }
  for (const std::string& id : ready_before_) {
    Known& known = jobs_.at(id);
    const Job* job = core.FindJob(id);
    if (given[id] > 0 || job == nullptr || !job->Running() || !job->tasks.HasReady()) {
      known.passed_over = 0;
      continue;
    }
    for (const auto& [peer, turn] : turns)  // on workers that could have served this job
      if (const Worker* worker = core.fleet().Find(peer); worker == nullptr || core.MayServe(*worker, *job))
        known.passed_over += turn;
    double fair = 0;
    for (const auto& [other_id, other] : jobs_)
      if (other_id != id) fair += known.largest_turn + other.largest_turn;
    if (known.passed_over > fair * (1 + 1e-9))
      Fail(id + " starves: others were given " + std::to_string(known.passed_over) +
           " s of work before it was its turn, " + std::to_string(fair) + " s were fair");
  }
}

void Checks::CountActions(const Core& core, const std::vector<Action>& actions) {
  for (const Action& action : actions) {
    if (std::holds_alternative<Persist>(action)) world_.Count(kPersist);
    if (std::holds_alternative<DropBlobs>(action)) world_.Count(kDrop);
    const auto* send = std::get_if<Send>(&action);
    if (send == nullptr) continue;
    const wire::Envelope& message = send->message;
    if (message.has_welcome()) world_.Count(kWelcome);
    if (message.has_refuse()) world_.Count(kRefuse);
    if (message.has_unknown_worker()) world_.Count(kUnknownWorker);
    if (message.has_cancel()) world_.Count(kCancel);
    if (message.has_drain()) world_.Count(kDrain);
    if (!message.has_assign()) continue;
    world_.Count(kAssign);
    const wire::TaskKey& key = message.assign().key();
    const Job* job = core.FindJob(key.job());
    if (!IsUnderWay(job, key)) {
      Fail("a task was dispatched that nobody waits for");
    } else {
      if (!job->Running()) Fail("a task of " + job->id + " was dispatched, which does not run");
      if (key.attempt() > 1) world_.Count(kAttemptAgain);
      if (job->tasks.task(key.task()).live_attempts.size() > 1) world_.Count(kCopied);
    }
  }
}

}  // namespace cairn::simulation
