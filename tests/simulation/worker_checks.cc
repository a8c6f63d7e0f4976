// What a worker that is to leave, or that is broken, may still get; that nobody is blamed for a leaving.
#include <algorithm>

#include "tests/simulation/checks.h"
#include "tests/simulation/world.h"

namespace cairn::simulation {

using namespace coordinator;  // NOLINT: events and actions, all over this file

namespace {

constexpr double kSoon_s = 30;    // less than CoreOptions::back_s
constexpr int kMostExcuses = 15;  // fewer than the core believes

}  // namespace

std::uint64_t Checks::Retries(const Core& core) const {
  std::uint64_t retries = 0;
  for (const auto& [id, known] : jobs_)
    if (const Job* job = core.FindJob(id))
      for (const proto::StageFacts& facts : job->facts) retries += facts.retries();
  return retries;
}

// From when the core knows that a worker drains until it is gone.
void Checks::SeeDraining(const Core& core, const Event& event, const std::vector<Action>& actions) {
  const auto* drain = std::get_if<DrainWorker>(&event);
  if (drain != nullptr && core.fleet().Knows(drain->peer)) draining_.insert(drain->peer);
  std::erase_if(draining_, [&core](const std::string& peer) { return !core.fleet().Knows(peer); });
  for (const std::string& peer : draining_)
    if (core.fleet().Find(peer)->assigned.size() > 1) Fail(peer + " drains, and keeps what it has queued");
  const auto* heartbeat = std::get_if<WorkerHeartbeat>(&event);
  bool told = false;
  for (const Action& action : actions) {
    const auto* send = std::get_if<Send>(&action);
    if (send == nullptr) continue;
    if (send->message.has_assign() && draining_.contains(send->peer))
      Fail(send->peer + " drains, and is given a task");
    if (drain != nullptr && send->peer == drain->peer && send->message.has_cancel())
      world_.Count(kDrainedOfQueued);
    told |= heartbeat != nullptr && send->peer == heartbeat->peer && send->message.has_drain();
  }
  if (heartbeat != nullptr && draining_.contains(heartbeat->peer) && !told)
    Fail(heartbeat->peer + " is to leave, and is not told so again");
  if ((drain != nullptr || std::holds_alternative<WorkerLeave>(event)) && Retries(core) != retries_before_)
    Fail("somebody is blamed because a worker leaves");
}

// One worker alone does not use up a task's attempts by answers that anybody sees are wrong.
void Checks::SeeExcluded(const Core& core, const std::vector<Action>& actions) {
  if (!broken_.first.empty()) {
    malformed_[broken_.first].insert(broken_.second);
    world_.Count(kExcluded);
  }
  std::erase_if(malformed_, [&core](const auto& entry) { return core.FindJob(entry.first) == nullptr; });
  for (const Action& action : actions) {
    const auto* send = std::get_if<Send>(&action);
    if (send == nullptr || !send->message.has_assign()) continue;
    const std::string& id = send->message.assign().key().job();
    const Worker* worker = core.fleet().Find(send->peer);
    const auto broken = malformed_.find(id);
    if (worker == nullptr || broken == malformed_.end() || !broken->second.contains(worker->number)) continue;
    const auto& workers = core.fleet().workers();
    if (std::any_of(workers.begin(), workers.end(), [&](const auto& other) {
          return other.second.Able() && !broken->second.contains(other.first);
        }))
      Fail(send->peer + " gave malformed answers to " + id + " and gets more of its tasks");
    world_.Count(kExcludedAlone);
  }
}

void Checks::ForgetWorkers() {
  draining_.clear();
  malformed_.clear();
  lost_.clear();
  there_.clear();
  heard_.clear();
  spared_.clear();
  now_s_ = ticked_s_ = spared_until_s_ = 0;
}

// Null where it is not under way any more.
const TaskRecord* Checks::FindLost(const Core& core, const Lost& lost) const {
  const Job* job = core.FindJob(lost.key.job());
  return job != nullptr && !job->Ended() && job->IsUnderWay(lost.key) ? &job->tasks.task(lost.key.task())
                                                                      : nullptr;
}

void Checks::NoteLost(const Core& core, const Event& event) {
  blamed_before_.reset();
  if (const auto* lost = std::get_if<WorkerLost>(&event); lost != nullptr && !lost->ended) {
    const Worker* worker = core.fleet().Find(lost->peer);
    if (worker != nullptr && !worker->assigned.empty())
      lost_[worker->hello.process()] = {worker->assigned.front().key, now_s_};
  }
  const auto* hello = std::get_if<WorkerHello>(&event);
  const auto lost = hello != nullptr ? lost_.find(hello->hello.process()) : lost_.end();
  if (lost == lost_.end()) return;
  if (const TaskRecord* task = FindLost(core, lost->second);
      task != nullptr && task->status != TaskStatus::kDone && task->failures > 0)
    blamed_before_ = task->failures;
}

// A process that comes back soon has not ended: what it lost with its connection is no failure of the task.
void Checks::SeeBack(const Core& core, const Event& event) {
  const auto* hello = std::get_if<WorkerHello>(&event);
  const auto lost = hello != nullptr ? lost_.extract(hello->hello.process()) : decltype(lost_)::node_type();
  if (lost.empty() || !blamed_before_ || now_s_ - lost.mapped().since_s > kSoon_s) return;
  const TaskRecord* task = FindLost(core, lost.mapped());
  if (task == nullptr || task->excuses >= kMostExcuses) return;
  if (task->failures != *blamed_before_ - 1)
    Fail(hello->peer + " is back, and its task is still blamed for its loss");
  world_.Count(kBlameTakenBack);
}

void Checks::NoteRunning(const Core& core, const Event& event) {
  running_before_.clear();
  if (!std::holds_alternative<Tick>(event)) return;
  for (const auto& [number, worker] : core.fleet().workers()) {
    if (worker.assigned.empty()) continue;
    const wire::TaskKey& key = worker.assigned.front().key;
    if (const TaskRecord* task = FindLost(core, {key, now_s_}); task != nullptr)
      running_before_.push_back({worker.peer, key, task->failures, task->excuses});
  }
}

// Whoever goes silent may have gone with its machine: that is no failure of the task that it ran.
void Checks::SeeSilent(const Core& core) {
  const auto& workers = core.fleet().workers();
  const bool hung = std::ranges::any_of(workers, [](const auto& entry) { return entry.second.hung; });
  for (const Running& before : running_before_) {
    const TaskRecord* task = FindLost(core, {before.key, now_s_});
    if (core.fleet().Knows(before.peer) || task == nullptr || task->excuses >= kMostExcuses) continue;
    if (task->failures != before.failures && !hung) Fail(before.peer + " was silent, and its task is blamed");
    if (task->excuses > before.excuses) world_.Count(kLostWithNode);
  }
}

// Nobody is taken for silent because nobody listened.
void Checks::SeeStandstill(const Core& core, bool ticked, double now_s) {
  const double lease_s = world_.faults.core.lease_s;
  if (ticked_s_ > 0 && now_s - ticked_s_ > 0.5 * lease_s) {
    if (!heard_.empty()) world_.Count(kStoodStill);
    spared_ = heard_;
    spared_until_s_ = now_s + 0.5 * lease_s;
    ticked_s_ = now_s;
  }
  if (ticked && now_s < spared_until_s_)
    for (const std::string& peer : spared_)
      if (there_.contains(peer) && !core.fleet().Knows(peer))
        Fail(peer + " is taken for silent, though it was the coordinator that stood still");
  if (ticked) ticked_s_ = now_s;
  now_s_ = now_s;
  there_.clear();
  heard_.clear();
  for (const auto& [number, worker] : core.fleet().workers()) {
    there_.insert(worker.peer);
    if (now_s - worker.heard_s < 0.25 * lease_s) heard_.insert(worker.peer);
  }
}

}  // namespace cairn::simulation
