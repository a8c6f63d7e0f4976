// The workers that are connected and what each is assigned. A worker runs its tasks in the order in which it
// got them, so that the first assigned is the one that runs.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "coordinator/core/blob_ledger.h"
#include "schema/wire.pb.h"

namespace cairn::coordinator {

bool SameTask(const wire::TaskKey& a, const wire::TaskKey& b);  // whatever the attempt
bool SameAttempt(const wire::TaskKey& a, const wire::TaskKey& b);

std::string WorkerName(const wire::Hello& hello);  // for people

struct AssignedTask {
  wire::TaskKey key;
  double since_s = 0;  // when it was sent
  std::uint64_t ticks = 0;
};

struct Worker {
  std::uint64_t number = 0;  // by the order in which they were accepted
  std::string peer;
  wire::Hello hello;
  double heartbeat_s = 1;  // it was told to send one at least this often
  double heard_s = 0;      // last sign of life
  double moved_s = 0;      // last sign of progress: an answer, a tick, or its first task
  double head_s = 0;       // when the first assigned came to be the first
  double joined_s = 0;
  double load = 0;  // as its last heartbeat says
  std::uint64_t memory_bytes = 0;
  std::uint64_t failures = 0;  // attempts that failed at it
  bool hung = false;           // gets nothing until it moves again
  bool draining = false;       // gets nothing any more, and leaves
  bool doubted = false;        // another was lost since this one was last heard of: it may be gone, too
  std::vector<AssignedTask> assigned;
  HashSet has;  // blobs that it was sent or made; it may have forgotten some

  bool Able() const { return !hung && !draining; }
  bool HasRoom() const { return assigned.size() < hello.slots() && Able() && !doubted; }
  const AssignedTask* Find(const wire::TaskKey& key) const;
  // Ticks of what it is assigned. True where one moved.
  bool Tick(const wire::TaskKey& key, std::uint64_t ticks, double now_s);
  void TakeVitals(const wire::Heartbeat& heartbeat);
};

// No call but the loops over workers() costs more than the logarithm of their number.
class Fleet {
 public:
  Fleet() = default;
  Fleet(const Fleet&) = delete;  // it points into itself
  Fleet& operator=(const Fleet&) = delete;
  Worker& Add(const std::string& peer, const wire::Hello& hello, double now_s);
  void Remove(const std::string& peer);
  Worker* Find(const std::string& peer);
  const Worker* Find(const std::string& peer) const { return const_cast<Fleet*>(this)->Find(peer); }
  // Of the same process, over whatever connection. (A host's name and a process id two may have in common.)
  Worker* FindProcess(const wire::Hello& hello);
  const Worker* FindProcess(const wire::Hello& hello) const {
    return const_cast<Fleet*>(this)->FindProcess(hello);
  }
  bool Knows(const std::string& peer) const { return by_peer_.contains(peer); }
  Worker* Find(std::uint64_t number);
  std::size_t size() const { return workers_.size(); }
  std::map<std::uint64_t, Worker>& workers() { return workers_; }  // by number
  const std::map<std::uint64_t, Worker>& workers() const { return workers_; }

  // For so long nobody listened: that counts for nobody.
  void LeaveOut(double seconds, double now_s);

  // What changes what a worker may get goes through here.
  void Give(Worker& worker, const wire::TaskKey& key, double now_s);
  // False where it did not have it.
  bool Take(Worker& worker, const wire::TaskKey& key, double now_s);
  void SetHung(Worker& worker, bool hung);
  void SetDraining(Worker& worker);
  // Where a network fails it is not one worker that is lost: until each was heard of again it gets nothing,
  // or one task would be lost with one worker after the other.
  void DoubtAll();
  void Trust(Worker& worker);
  void NoteBlob(Worker& worker, const Hash& blob);  // it was sent it, or made it
  void Forget(const std::vector<Hash>& dropped);

  bool AnyRoom() const { return !open_.empty(); }
  std::size_t able() const { return able_; }  // workers that may get tasks now or later
  // Of the workers that have room and are none of `but`, one with the least assigned; of the first few of
  // these the one that holds most of the first of `inputs`. Null where there is none.
  Worker* Place(std::span<const Hash> inputs, const std::set<std::uint64_t>& but = {});
  Worker* Idle(const std::set<std::uint64_t>& but = {});  // that may get tasks and has none; null as above
  Worker* Busiest();  // with the most assigned, at least two; null where there is none

 private:
  using ByLoad = std::map<std::pair<std::size_t, std::uint64_t>, Worker*>;  // tasks assigned, number
  template <class Change>
  void Refile(Worker& worker, const Change& change);
  void Unfile(const Worker& worker);

  std::uint64_t next_number_ = 1;
  std::map<std::uint64_t, Worker> workers_;
  std::unordered_map<std::string, Worker*> by_peer_;
  std::map<std::uint64_t, std::uint64_t> processes_;  // numbers, by Hello.process where it says one
  std::size_t able_ = 0;
  ByLoad open_;                           // those that have room
  ByLoad loaded_;                         // those with two and more assigned
  HashMap<std::vector<Worker*>> owners_;  // workers by what they have
};

const char* StateName(const Worker& worker);  // "idle"

// All but the name of the task that runs.
wire::WorkerInfo MakeInfo(const Worker& worker, double now_s);

// What differs from the coordinator's build, for people; empty where nothing does.
std::string BuildDifference(const wire::Build& coordinators, const wire::Build& have);

}  // namespace cairn::coordinator
