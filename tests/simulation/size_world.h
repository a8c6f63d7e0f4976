// A fleet of any size at one coordinator, to see where it ends: the real core, whose time is taken by the
// clock as it runs, and around it what the event loop and ZeroMQ's thread take for each message and each
// connection, as tests/swarm measures them. What it finds is a measurement, and differs a little from run to
// run.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <queue>
#include <string>
#include <vector>

#include "coordinator/core/core.h"
#include "schema/rng.h"

namespace cairn::simulation {

struct SizeOptions {
  std::uint32_t workers = 10'000, slots = 4, jobs = 4, tasks_a_worker = 2;  // of a round
  double join_s = 10;               // they come over so long, and half as long is waited for them
  double task_s = 1, seconds = 20;  // then the coordinator is killed, and as long again watched
  // Of the event loop for a message in or out, beside the core's; of ZeroMQ's thread for one, and for a
  // connection that is made.
  double message_us = 5, socket_us = 7, join_us = 60;
  double restart_s = 0.5;          // until a coordinator that was killed listens again
  std::uint32_t newcomers = 4096;  // connections that may have said nothing yet (wire::Places)
};

// What the threads are for.
enum class Cause : std::uint8_t { kJoin, kHeartbeat, kTask, kTick };
inline constexpr std::size_t kCauses = 4;

// Processor time of the event loop and of ZeroMQ's thread.
struct ThreadTime {
  double loop_s = 0, sockets_s = 0;
};

struct SizeOutcome {
  std::uint32_t joined = 0;  // when counting began
  std::array<ThreadTime, kCauses> a_second;
  double tasks_per_s = 0;
  double busy = 0;                         // of the workers, on average
  double loop = 0, core = 0, sockets = 0;  // processor time a second, of the threads; `core` is within `loop`
  double longest_tick_s = 0, longest_silence_s = 0;
  std::uint64_t lost = 0, turned_away = 0;
  double back_s = -1;  // from the kill until each worker had a task again; -1: not all had
  std::uint32_t back = 0;
};

class SizeWorld {
 public:
  explicit SizeWorld(const SizeOptions& options);
  SizeOutcome Run();

 private:
  enum class What {
    kKnock,
    kHandshake,
    kArrive,
    kQueue,
    kTurn,
    kHear,
    kTaskEnd,
    kHeartbeat,
    kPersisted,
    kTick
  };
  struct Happening {
    double at_s = 0;
    std::uint64_t order = 0;
    What what = What::kTick;
    std::uint32_t worker = 0, generation = 0;
    std::optional<coordinator::Event> event = {};   // for the core
    std::optional<wire::Envelope> message = {};     // for the worker
    bool operator<(const Happening& other) const {  // the first is on top
      return at_s != other.at_s ? at_s > other.at_s : order > other.order;
    }
  };
  struct Worker {
    std::string peer;
    std::uint32_t generation = 0;  // of its connections
    double pause_s = 0, busy_s = 0, heartbeat_s = 1;
    bool newcomer = false;  // it is connected and its first word was not taken yet
    bool worked = false;    // since the coordinator was started
    std::deque<wire::TaskKey> assigned;
  };

  static bool IsOfCoordinator(What what);  // else of a worker's connection
  void Push(double in_s, What what, std::uint32_t worker = 0, std::optional<coordinator::Event> event = {},
            std::optional<wire::Envelope> message = {});
  void Happen(Happening& happening);
  void Start();
  void Kill();
  void Knock(std::uint32_t number);
  void TryLater(std::uint32_t number);
  void Queue(std::uint32_t number, coordinator::Event event);
  void Turn();
  void Tick();
  void Handle(const coordinator::Event& event, Cause cause);
  void Hear(std::uint32_t number, const wire::Envelope& message);
  void EndTask(std::uint32_t number);
  void SayHeartbeat(std::uint32_t number);
  double Sockets(double us, Cause cause);  // when ZeroMQ's thread is through with it, from now on
  ThreadTime& Of(Cause cause) { return spent_[static_cast<std::size_t>(cause)]; }

  const SizeOptions options_;
  Rng rng_;
  double now_s_ = 0;
  std::uint64_t next_order_ = 0;
  std::priority_queue<Happening> happenings_;
  std::optional<coordinator::Core> core_;
  bool up_ = false;
  std::uint32_t epoch_ = 0;
  double core_began_s_ = 0, sockets_free_s_ = 0, loop_free_s_ = 0, ticked_s_ = 0, killed_s_ = 0;
  std::uint32_t newcomers_ = 0;
  std::deque<std::pair<std::uint32_t, coordinator::Event>> queue_;  // for the event loop
  std::vector<Worker> workers_;
  std::map<std::string, std::uint32_t> numbers_;  // by peer
  std::uint64_t done_ = 0;
  std::array<ThreadTime, kCauses> spent_;
  double core_s_ = 0;
  SizeOutcome outcome_;
};

}  // namespace cairn::simulation
