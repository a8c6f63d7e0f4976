#include "coordinator/core/fleet.h"

#include <algorithm>

namespace cairn::coordinator {
namespace {

// So that placing costs the same however large the fleet and the reduction are.
constexpr std::size_t kWorkersLookedAt = 32, kInputsLookedAt = 64;

}  // namespace

bool SameTask(const wire::TaskKey& a, const wire::TaskKey& b) {
  return a.task() == b.task() && a.round() == b.round() && a.stage() == b.stage() && a.kind() == b.kind() &&
         a.job() == b.job();
}

bool SameAttempt(const wire::TaskKey& a, const wire::TaskKey& b) {
  return a.attempt() == b.attempt() && SameTask(a, b);
}

std::string WorkerName(const wire::Hello& hello) {
  return "worker " + std::to_string(hello.pid()) + " on " + (hello.host().empty() ? "?" : hello.host());
}

const AssignedTask* Worker::Find(const wire::TaskKey& key) const {
  for (const AssignedTask& task : assigned)
    if (SameAttempt(task.key, key)) return &task;
  return nullptr;
}

void Worker::TakeVitals(const wire::Heartbeat& heartbeat) {
  constexpr double kMostLoad = 1e6;
  load = heartbeat.load() >= 0 && heartbeat.load() < kMostLoad ? heartbeat.load() : 0;
  memory_bytes = heartbeat.memory_bytes();
}

bool Worker::Tick(const wire::TaskKey& key, std::uint64_t ticks, double now_s) {
  for (AssignedTask& task : assigned) {
    if (ticks <= task.ticks || !SameAttempt(task.key, key)) continue;
    task.ticks = ticks;
    moved_s = now_s;
    return true;
  }
  return false;
}

void Fleet::Unfile(const Worker& worker) {
  open_.erase({worker.assigned.size(), worker.number});
  loaded_.erase({worker.assigned.size(), worker.number});
  if (worker.Able()) --able_;
}

// Takes the worker out of the files, changes it, and files it anew.
template <class Change>
void Fleet::Refile(Worker& worker, const Change& change) {
  Unfile(worker);
  change();
  if (worker.Able()) ++able_;
  const std::pair filed{worker.assigned.size(), worker.number};
  if (worker.HasRoom()) open_.emplace(filed, &worker);
  if (worker.assigned.size() >= 2) loaded_.emplace(filed, &worker);
}

Worker& Fleet::Add(const std::string& peer, const wire::Hello& hello, double now_s) {
  const std::uint64_t number = next_number_++;
  if (hello.process() != 0) processes_[hello.process()] = number;
  Worker& worker = workers_[number];
  by_peer_[peer] = &worker;
  worker.number = number;
  worker.peer = peer;
  worker.hello = hello;
  worker.joined_s = worker.heard_s = worker.moved_s = worker.head_s = now_s;
  ++able_;  // so that Unfile finds it filed
  Refile(worker, [] {});
  return worker;
}

void Fleet::Remove(const std::string& peer) {
  const auto it = by_peer_.find(peer);
  if (it == by_peer_.end()) return;
  Worker& worker = *it->second;
  Unfile(worker);
  for (const Hash& blob : worker.has) {
    const auto owners = owners_.find(blob);
    std::erase(owners->second, &worker);
    if (owners->second.empty()) owners_.erase(owners);
  }
  const auto process = processes_.find(worker.hello.process());
  if (process != processes_.end() && process->second == worker.number) processes_.erase(process);
  by_peer_.erase(it);
  workers_.erase(worker.number);
}

Worker* Fleet::Find(const std::string& peer) {
  const auto it = by_peer_.find(peer);
  return it == by_peer_.end() ? nullptr : it->second;
}

Worker* Fleet::Find(std::uint64_t number) {
  const auto it = workers_.find(number);
  return it == workers_.end() ? nullptr : &it->second;
}

Worker* Fleet::FindProcess(const wire::Hello& hello) {
  const auto it = processes_.find(hello.process());
  return it == processes_.end() ? nullptr : &workers_.at(it->second);
}

void Fleet::LeaveOut(double seconds, double now_s) {
  const auto shift = [&](double& at_s) { at_s = std::min(now_s, at_s + seconds); };
  for (auto& [number, worker] : workers_) {
    for (double* at_s : {&worker.heard_s, &worker.moved_s, &worker.head_s}) shift(*at_s);
    for (AssignedTask& task : worker.assigned) shift(task.since_s);
  }
}

void Fleet::Give(Worker& worker, const wire::TaskKey& key, double now_s) {
  if (worker.assigned.empty()) worker.moved_s = worker.head_s = now_s;
  Refile(worker, [&] { worker.assigned.push_back({key, now_s, 0}); });
}

bool Fleet::Take(Worker& worker, const wire::TaskKey& key, double now_s) {
  const auto it = std::find_if(worker.assigned.begin(), worker.assigned.end(),
                               [&key](const AssignedTask& task) { return SameAttempt(task.key, key); });
  if (it == worker.assigned.end()) return false;
  if (it == worker.assigned.begin()) worker.moved_s = worker.head_s = now_s;
  Refile(worker, [&] { worker.assigned.erase(it); });
  return true;
}

void Fleet::SetHung(Worker& worker, bool hung) {
  if (worker.hung != hung) Refile(worker, [&] { worker.hung = hung; });
}

void Fleet::SetDraining(Worker& worker) {
  Refile(worker, [&] { worker.draining = true; });
}

void Fleet::DoubtAll() {
  for (auto& [number, worker] : workers_)
    if (!worker.doubted) Refile(worker, [&worker] { worker.doubted = true; });
}

void Fleet::Trust(Worker& worker) {
  if (worker.doubted) Refile(worker, [&worker] { worker.doubted = false; });
}

void Fleet::NoteBlob(Worker& worker, const Hash& blob) {
  if (worker.has.insert(blob).second) owners_[blob].push_back(&worker);
}

void Fleet::Forget(const std::vector<Hash>& dropped) {
  for (const Hash& blob : dropped) {
    const auto node = owners_.extract(blob);
    if (node.empty()) continue;
    for (Worker* worker : node.mapped()) worker->has.erase(blob);
  }
}

Worker* Fleet::Place(std::span<const Hash> inputs, const std::set<std::uint64_t>& but) {
  inputs = inputs.first(std::min(inputs.size(), kInputsLookedAt));
  Worker* best = nullptr;
  std::ptrdiff_t best_missing = 0;
  std::size_t looked_at = 0;
  for (auto it = open_.begin(); it != open_.end() && looked_at < kWorkersLookedAt; ++it) {
    Worker& worker = *it->second;
    if (but.contains(worker.number)) continue;
    if (best != nullptr && worker.assigned.size() > best->assigned.size()) break;
    ++looked_at;
    const auto missing = std::count_if(inputs.begin(), inputs.end(),
                                       [&worker](const Hash& hash) { return !worker.has.contains(hash); });
    if (best == nullptr || missing < best_missing) best = &worker, best_missing = missing;
  }
  return best;
}

Worker* Fleet::Idle(const std::set<std::uint64_t>& but) {
  for (auto it = open_.begin(); it != open_.end() && it->second->assigned.empty(); ++it)
    if (!but.contains(it->second->number)) return it->second;
  return nullptr;
}

Worker* Fleet::Busiest() { return loaded_.empty() ? nullptr : loaded_.rbegin()->second; }

const char* StateName(const Worker& worker) {
  if (worker.draining) return "draining";
  if (worker.hung) return "hung";
  return worker.assigned.empty() ? "idle" : "busy";
}

wire::WorkerInfo MakeInfo(const Worker& worker, double now_s) {
  wire::WorkerInfo info;
  info.set_number(worker.number);
  info.set_host(worker.hello.host());
  info.set_pid(worker.hello.pid());
  info.set_name(worker.hello.name());
  info.set_state(StateName(worker));
  info.set_slots(worker.hello.slots());
  info.set_assigned(static_cast<std::uint32_t>(worker.assigned.size()));
  info.set_silent_s(now_s - worker.heard_s);
  info.set_joined_s(now_s - worker.joined_s);
  info.set_failures(worker.failures);
  info.set_load(worker.load);
  info.set_memory_bytes(worker.memory_bytes);
  if (!worker.assigned.empty()) info.set_task_s(now_s - worker.head_s);
  return info;
}

std::string BuildDifference(const wire::Build& coordinators, const wire::Build& have) {
  std::string text;
  const auto compare = [&text](const char* what, const std::string& a, const std::string& b) {
    if (a == b) return;
    text +=
        (text.empty() ? "" : "; ") + std::string(what) + " is '" + b + "', the coordinator's is '" + a + "'";
  };
  compare("version", coordinators.version(), have.version());
  compare("hash of the sources", coordinators.sources(), have.sources());
  compare("compiler", coordinators.compiler(), have.compiler());
  compare("flags", coordinators.flags(), have.flags());
  compare("libc", coordinators.libc(), have.libc());
  if (coordinators.numeric_self_test() != have.numeric_self_test())
    text += std::string(text.empty() ? "" : "; ") + "its numeric self-test gives other bits";
  return text;
}

}  // namespace cairn::coordinator
