// A worker as the coordinator sees it: says Hello, sends heartbeats, fetches what its tasks read, blobs and
// parts of them, and computes them one after the other. It may be slow, hang, be stopped, die, forget, lie,
// or be of another build.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "schema/hash.h"
#include "schema/wire.pb.h"
#include "tests/simulation/lies.h"

namespace cairn::simulation {

class World;

struct WorkerTraits {
  std::string build = "1";
  double speed = 1;
  std::uint32_t slots = 1;
  bool lies = false;
};

class WorkerModel {
 public:
  WorkerModel(World& world, std::string name, WorkerTraits traits);
  void Start();
  void Receive(const wire::Envelope& message);
  bool alive() const { return alive_; }
  void Crash();
  void Leave();
  void BeTerminated();             // drains for some seconds, then leaves in any case
  void BreakConnection();          // and says Hello anew, before the coordinator sees it or after
  void Hang();                     // what computes stands still, heartbeats go on
  void StopUntil(double until_s);  // all of it stands still; what comes meanwhile waits
  void JumpClock(double by_s) { clock_jump_s_ += by_s; }

 private:
  struct Held {
    wire::Assign assign;
    std::uint64_t ticks = 0;
    std::map<Hash, wire::Fetch> lacking;  // by the names that the answers have
    bool hopeless = false;                // some of it is not to be had
  };
  bool Foreign() const { return traits_.build != "1"; }
  void SayHello();
  void KeepSayingHello();
  void KeepHeartbeat();
  void KeepFetching();
  void Take(const wire::Assign& assign);
  void Take(const wire::BlobData& data);
  void Take(const wire::Missing& missing);
  void Drop(const wire::TaskKey& key);
  void LeaveIfDrained();
  void BeginNext();
  void FinishFirst();
  void SendAnswer(const Held& held);
  void Forget();

  World& world_;
  const std::string name_;
  const WorkerTraits traits_;
  bool alive_ = true, hung_ = false, welcomed_ = false, refused_ = false, computing_ = false;
  bool draining_ = false, terminated_ = false;
  double stopped_until_s_ = 0, clock_jump_s_ = 0;
  std::uint64_t computation_ = 0;  // numbered, so that what was called off does not end
  std::deque<Held> queue_;
  std::set<Hash> has_;  // what it has fetched
};

}  // namespace cairn::simulation
