// Thousands of workers in one process and one thread: each has a connection of its own, says what a worker
// says (worker/session.h), and answers its tasks in turn, at once or after a time.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <memory>
#include <queue>
#include <string>
#include <vector>

#include "schema/job.pb.h"
#include "schema/wire.pb.h"
#include "tests/swarm/zmtp_peer.h"

namespace cairn::swarm {

// Of so many rounds with so many tasks each, which take so long and do nothing.
proto::Job MakeJob(const std::string& name, int tasks, int rounds, int task_ms);

// What all workers did; of all processes that were forked since it was made.
class Shared {
 public:
  Shared(std::size_t workers, std::size_t tasks);

  struct Sums {
    std::atomic<std::uint64_t> bytes_in{0}, bytes_out{0}, heartbeats{0}, connections{0}, broken{0},
        assigned{0}, called_back{0};
    std::atomic<std::int64_t> longest_turn_ns{0};
    std::atomic<int> epoch{0};  // counts the coordinators
  };
  Sums& sums() const { return *sums_; }
  // By worker: the last epoch in which it began a connection over which it answered a task, and when it did
  // first.
  std::atomic<std::int64_t>& given_ns(std::size_t worker) const { return given_ns_[worker]; }
  std::atomic<int>& given_in(std::size_t worker) const { return given_in_[worker]; }
  // How often each task ran.
  std::atomic<std::uint8_t>& runs(std::size_t task) const { return runs_[task]; }

 private:
  Sums* sums_;
  std::atomic<std::int64_t>* given_ns_;
  std::atomic<int>* given_in_;
  std::atomic<std::uint8_t>* runs_;
};

struct SwarmOptions {
  std::string endpoint;
  int first = 0, count = 1;    // workers, by number
  int nodes = 1;               // machines that they are on: each has an address and a key of its own
  std::vector<PeerKeys> keys;  // by node; none: without keys
  int slots = 4;
};

std::int64_t NowNs();

class Swarm {
 public:
  Swarm(SwarmOptions options, const Shared& shared);
  [[noreturn]] void Serve();

 private:
  struct Assigned {
    wire::TaskKey key;
    double seconds = 0;
  };
  struct Worker {
    int number = 0;
    std::unique_ptr<ZmtpPeer> peer;
    std::uint32_t generation = 0;  // of its connections
    int epoch = 0;
    bool said_hello = false, welcome = false, wants_to_write = false;
    double pause_s = 0, heartbeat_s = 1;
    std::deque<Assigned> assigned;
  };
  enum class Due { kConnect, kHeartbeat, kPing, kTask };
  struct Timer {
    double at_s;
    int worker;
    std::uint32_t generation;
    Due due;
    bool operator<(const Timer& other) const { return at_s > other.at_s; }  // the soonest is on top
  };

  void Connect(Worker& worker);
  void Lose(Worker& worker);
  void Turn(Worker& worker);
  void Watch(Worker& worker);
  void Fire(const Timer& timer);
  void At(double at_s, const Worker& worker, Due due);
  void Take(Worker& worker, const std::vector<std::string>& frames);
  void TakeAssign(Worker& worker, const wire::Assign& assign);
  void TakeCancel(Worker& worker, const wire::TaskKey& key);
  void Answer(Worker& worker, const wire::Assign& assign);
  void AnswerTask(Worker& worker, const wire::TaskKey& key, double seconds);
  void Send(Worker& worker, wire::Envelope envelope);
  void SayHello(Worker& worker);
  void SayHeartbeat(Worker& worker);
  double Random() {
    return static_cast<double>(random_ = random_ * 6364136223846793005u + 1442695040888963407u) / 0x1p64;
  }

  const SwarmOptions options_;
  const Shared& shared_;
  wire::Build build_;
  int epoll_ = -1;
  double now_s_ = 0;
  std::uint64_t random_;
  std::vector<Worker> workers_;
  std::priority_queue<Timer> timers_;
};

}  // namespace cairn::swarm
