// A worker as the coordinator sees it: says Hello, beats, computes what it is given one after the other. It
// may be slow, hang, die, forget, or be of another build.
#pragma once

#include <cstdint>
#include <deque>
#include <set>
#include <string>

#include "schema/hash.h"
#include "schema/wire.pb.h"

namespace cairn::simulation {

class World;

class WorkerModel {
 public:
  WorkerModel(World& world, std::string name, std::string build, double speed, std::uint32_t slots);
  void Start();
  void Receive(const wire::Envelope& message);
  bool alive() const { return alive_; }
  bool hung() const { return hung_; }
  void Crash();
  void Leave();
  void Hang();

 private:
  struct Held {
    wire::Assign assign;
    std::uint64_t ticks = 0;
  };
  void SayHello();
  void KeepSayingHello();
  void BeatOn();
  void BeginNext();
  void FinishFirst();
  void Forget();
  bool HasInputs(const wire::Assign& assign);

  World& world_;
  const std::string name_, build_;
  const double speed_;
  const std::uint32_t slots_;
  bool alive_ = true, hung_ = false, welcomed_ = false, refused_ = false, computing_ = false;
  std::uint64_t computation_ = 0;  // numbered, so that what was called off does not end
  std::deque<Held> queue_;
};

}  // namespace cairn::simulation
