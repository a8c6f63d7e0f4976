// What a worker that is to leave, or that is broken, may still get; that nobody is blamed for a leaving.
#include <algorithm>

#include "tests/simulation/checks.h"
#include "tests/simulation/world.h"

namespace cairn::simulation {

using namespace coordinator;  // NOLINT: events and actions, all over this file

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

}  // namespace cairn::simulation
