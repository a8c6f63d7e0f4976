// The workers that are connected and what each has in hand. A worker runs its tasks in the order in which it
// got them, so that the first in hand is the one that runs.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/blob_ledger.h"
#include "schema/wire.pb.h"

namespace cairn::coordinator {

bool SameTask(const wire::TaskKey& a, const wire::TaskKey& b);  // whatever the attempt
bool SameAttempt(const wire::TaskKey& a, const wire::TaskKey& b);

struct InHand {
  wire::TaskKey key;
  double since_s = 0;  // when it was sent
  std::uint64_t ticks = 0;
};

struct Worker {
  std::uint64_t number = 0;  // by the order in which they were accepted
  std::string peer;
  wire::Hello hello;
  double heard_s = 0;  // last sign of life
  double moved_s = 0;  // last sign of progress: an answer, a tick, or its first task
  double head_s = 0;   // when the first in hand came to be the first
  bool hung = false;   // gets nothing until it moves again
  std::vector<InHand> in_hand;
  HashSet has;                     // blobs that it was sent or made; it may have forgotten some

  bool Idle() const { return in_hand.empty() && !hung; }
  bool HasRoom() const { return in_hand.size() < hello.slots() && !hung; }
  const InHand* Find(const wire::TaskKey& key) const;
  void Give(const wire::TaskKey& key, double now_s);
  // False where it did not have it.
  bool Take(const wire::TaskKey& key, double now_s);
  // Ticks of what it has in hand. True where one moved.
  bool Tick(const wire::TaskKey& key, std::uint64_t ticks, double now_s);
};

class Fleet {
 public:
  Worker& Add(const std::string& peer, const wire::Hello& hello, double now_s);
  void Remove(const std::string& peer);
  Worker* Find(const std::string& peer);
  const Worker* Find(const std::string& peer) const { return const_cast<Fleet*>(this)->Find(peer); }
  bool Knows(const std::string& peer) const { return numbers_.contains(peer); }
  std::size_t size() const { return workers_.size(); }
  std::map<std::uint64_t, Worker>& workers() { return workers_; }  // by number
  const std::map<std::uint64_t, Worker>& workers() const { return workers_; }

  // The worker that has room and the least in hand; of equals the one that has most of `inputs`; then the
  // first.
  Worker* Place(const std::vector<Hash>& inputs);
  bool AnyRoom() const;
  void Forget(const std::vector<Hash>& dropped);

 private:
  std::uint64_t next_number_ = 1;
  std::map<std::uint64_t, Worker> workers_;
  std::map<std::string, std::uint64_t> numbers_;  // by peer
};

// What differs between two builds, for people; empty where nothing does.
std::string BuildDifference(const wire::Build& want, const wire::Build& have);

}  // namespace cairn::coordinator
