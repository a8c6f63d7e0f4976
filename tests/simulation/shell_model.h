// The coordinator's process without sockets: feeds the core, carries out its actions against a model of
// memory and the store, dies at any moment, and comes back with what was durable. (server.cc)
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "coordinator/core/core.h"
#include "coordinator/core/uploads.h"
#include "tests/simulation/store_model.h"
#include "tests/simulation/toy.h"

namespace cairn::simulation {

class World;

// All that the task reads.
std::set<Hash> InputsOf(const wire::Assign& assign);

class ShellModel {
 public:
  explicit ShellModel(World& world) : world_(world), store_(world) {}
  void Start();
  // From a socket or a user; lost while the process is down, late while it is stopped. `whole`: every blob's
  // content is what its hash says.
  void Deliver(const coordinator::Event& event, bool whole = true);
  // A blob, or a part of one, that a worker asks for.
  void Serve(const std::string& peer, const wire::Fetch& fetch);
  // From a client that brings what it hands in (UploaderModel).
  void Offer(const std::string& peer, const Hash& hash, std::uint64_t bytes);
  void Bring(const std::string& peer, wire::Piece piece);
  void Submit(const std::string& peer, const coordinator::SubmitJob& event);
  void Crash(bool power_cut, double down_s);
  void StopUntil(double until_s) { stopped_until_s_ = until_s; }
  void JumpClock(double by_s) { clock_offset_s_ += by_s; }
  void FillDiskUntil(double until_s) { store_.FillUntil(until_s); }
  // Whether what it reads is there still when it has ended. A task that is still wanted must have it.
  bool Serves(const wire::Assign& assign, const std::string& peer);
  const coordinator::Core* core() const { return core_.get(); }  // null while it is down
  const StoreModel& store() const { return store_; }
  bool KeepsForClients() const { return uploads_ != nullptr && uploads_->kept() > 0; }
  // An attempt that this process gave to `peer`.
  bool WasGiven(const std::string& peer, const wire::TaskKey& key) const;

 private:
  struct Kept {
    bool durable = false;
    std::uint64_t ticket = 0;
  };
  void TickOn();
  void Restart();
  void Handle(const coordinator::Event& event);
  void TakeIn(const coordinator::Event& event);
  void Keep(const std::vector<Hash>& blobs);
  void Apply(const coordinator::Action& action);
  void Do(const coordinator::Send& send);
  void Do(const coordinator::Persist& persist);
  void Do(const coordinator::DropBlobs& drop);
  void Do(const coordinator::ForgetJob& forget);
  void Do(const coordinator::Answer& answer);
  void Do(const coordinator::JobChanged&) {}
  void Do(const coordinator::Report&) {}
  void Do(const coordinator::Refused&) {}
  void Write(const coordinator::UploadAction& action);
  void Carry(coordinator::Uploads::Actions actions);
  void Do(const coordinator::OpenUpload& open);
  void Do(const coordinator::WritePiece& piece);
  void Do(const coordinator::CloseUpload& close);
  void Do(const coordinator::TellCredit& tell);
  void Do(const coordinator::AnswerOffer& answer);
  void Do(const coordinator::ReleaseBlob& release);
  void Do(const coordinator::DropUploader& drop);
  void RemoveUnknown(const Hash& hash);
  // Once the process goes on, where it is stopped; never, where it dies before.
  void WhenAwake(std::function<void()> what);
  void Wake();
  void Receive(const coordinator::Event& event, bool whole);
  void Take(const WriteDone& done);
  void CheckMissing(const std::string& peer, const Hash& hash);
  void CheckAssign(const std::set<Hash>& inputs);
  void CheckMemory();
  double Now();

  World& world_;
  StoreModel store_;  // it outlives the process
  std::unique_ptr<coordinator::Core> core_;
  std::unique_ptr<coordinator::Uploads> uploads_;  // lives with it
  std::deque<std::function<void()>> waiting_;      // for a process that is stopped to go on
  std::set<std::string> gone_;                     // clients that a message could not be sent to
  std::uint64_t process_ = 0;
  std::uint64_t last_number_ = 0;  // that a job was given
  double stopped_until_s_ = 0;
  double clock_offset_s_ = 0, clock_s_ = 0;  // the clock, and the last that was read of it
  std::map<Hash, Kept> memory_;
  std::map<std::string, std::set<Hash>> given_;  // attempts, with their workers -> the inputs
};

}  // namespace cairn::simulation
