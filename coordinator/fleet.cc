#include "coordinator/fleet.h"

#include <algorithm>
#include <tuple>

namespace cairn::coordinator {

bool SameTask(const wire::TaskKey& a, const wire::TaskKey& b) {
  return a.task() == b.task() && a.round() == b.round() && a.stage() == b.stage() && a.kind() == b.kind() &&
         a.job() == b.job();
}

bool SameAttempt(const wire::TaskKey& a, const wire::TaskKey& b) {
  return a.attempt() == b.attempt() && SameTask(a, b);
}

const InHand* Worker::Find(const wire::TaskKey& key) const {
  for (const InHand& task : in_hand)
    if (SameAttempt(task.key, key)) return &task;
  return nullptr;
}

void Worker::Give(const wire::TaskKey& key, double now_s) {
  if (in_hand.empty()) moved_s = head_s = now_s;
  in_hand.push_back({key, now_s, 0});
}

bool Worker::Take(const wire::TaskKey& key, double now_s) {
  const auto it =
      std::find_if(in_hand.begin(), in_hand.end(), [&](const InHand& t) { return SameAttempt(t.key, key); });
  if (it == in_hand.end()) return false;
  if (it == in_hand.begin()) moved_s = head_s = now_s;
  in_hand.erase(it);
  return true;
}

bool Worker::Tick(const wire::TaskKey& key, std::uint64_t ticks, double now_s) {
  for (InHand& task : in_hand) {
    if (ticks <= task.ticks || !SameAttempt(task.key, key)) continue;
    task.ticks = ticks;
    moved_s = now_s;
    return true;
  }
  return false;
}

Worker& Fleet::Add(const std::string& peer, const wire::Hello& hello, double now_s) {
  const std::uint64_t number = next_number_++;
  numbers_[peer] = number;
  Worker& worker = workers_[number];
  worker.number = number;
  worker.peer = peer;
  worker.hello = hello;
  worker.heard_s = worker.moved_s = worker.head_s = now_s;
  return worker;
}

void Fleet::Remove(const std::string& peer) {
  const auto it = numbers_.find(peer);
  if (it == numbers_.end()) return;
  workers_.erase(it->second);
  numbers_.erase(it);
}

Worker* Fleet::Find(const std::string& peer) {
  const auto it = numbers_.find(peer);
  return it == numbers_.end() ? nullptr : &workers_.at(it->second);
}

Worker* Fleet::Place(const std::vector<Hash>& inputs) {
  Worker* best = nullptr;
  std::tuple<std::size_t, std::size_t> best_score;
  for (auto& [number, worker] : workers_) {
    if (!worker.HasRoom()) continue;
    const auto missing = std::count_if(inputs.begin(), inputs.end(),
                                       [&worker](const Hash& hash) { return !worker.has.contains(hash); });
    const std::tuple score{worker.in_hand.size(), static_cast<std::size_t>(missing)};
    if (best == nullptr || score < best_score) best = &worker, best_score = score;
  }
  return best;
}

bool Fleet::AnyRoom() const {
  return std::any_of(workers_.begin(), workers_.end(),
                     [](const auto& entry) { return entry.second.HasRoom(); });
}

void Fleet::Forget(const std::vector<Hash>& dropped) {
  for (auto& [number, worker] : workers_)
    for (const Hash& hash : dropped) worker.has.erase(hash);
}

std::string BuildDifference(const wire::Build& want, const wire::Build& have) {
  std::string text;
  const auto compare = [&text](const char* what, const std::string& a, const std::string& b) {
    if (a == b) return;
    text += (text.empty() ? "" : "; ") + std::string(what) + " is '" + b + "', the others' is '" + a + "'";
  };
  compare("version", want.version(), have.version());
  compare("compiler", want.compiler(), have.compiler());
  compare("flags", want.flags(), have.flags());
  compare("libc", want.libc(), have.libc());
  if (want.numeric_self_test() != have.numeric_self_test())
    text += std::string(text.empty() ? "" : "; ") + "its numeric self-test gives other bits";
  return text;
}

}  // namespace cairn::coordinator
