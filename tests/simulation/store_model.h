// The coordinator's store: the one thread that writes, in the order in which it was asked (disk_writer.cc),
// and what a start finds there (recovery.cc). The process may die at any step of a write, and the machine
// with it.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "coordinator/core/events.h"
#include "coordinator/core/uploads.h"
#include "tests/simulation/disk_model.h"

namespace cairn::simulation {

class World;

struct WriteWork {
  std::uint64_t ticket = 0;
  std::optional<coordinator::Persist> persist;
  std::vector<Hash> blobs;   // of it, those that are not on disk yet
  std::vector<Hash> remove;  // else: blobs that nobody needs
  std::string forget;        // else: a job that is deleted
  // Else: of an upload, whose half file no start ever reads.
  std::optional<coordinator::UploadAction> upload = {};
};
struct WriteDone {
  std::uint64_t ticket = 0;
  std::string job;
  std::uint64_t number = 0;
  bool forgotten = false;     // it was a job that is deleted
  std::string problem;        // empty: all is durable
  std::vector<Hash> written;  // blobs
  std::uint64_t upload = 0, upload_bytes = 0;
  bool closed = false;  // the upload, with its blob:
  Hash blob = {};
};

class StoreModel {
 public:
  explicit StoreModel(World& world) : world_(world) {}

  // `tell` hears of each checkpoint, as long as the process lives.
  void BeginProcess(std::function<void(const WriteDone&)> tell) { tell_ = std::move(tell); }
  std::uint64_t next_ticket() const { return next_ticket_; }
  void Add(WriteWork work);
  void EndProcess(bool power_cut);
  void FillUntil(double until_s) { full_until_s_ = until_s; }
  // What the next process finds, in the order of submission; some of it damaged before.
  std::vector<coordinator::RestoreJob> Recover();
  // Pieces that wait to be written.
  std::uint64_t QueuedBytes() const;
  bool Has(const Hash& blob) const { return blobs_.Read(blob) != nullptr; }
  // That any job was ever given, of what is durable.
  std::uint64_t LastNumber() const;
  // The newest of a job; null where there is none.
  const proto::Checkpoint* Newest(const std::string& job) const;

 private:
  using CheckpointPtr = std::shared_ptr<const proto::Checkpoint>;
  using Checkpoints = FolderModel<std::uint64_t, CheckpointPtr>;  // of a job, by number

  void BeginNext();
  DiskOutcome Step(DiskStep step);
  DiskOutcome Perform(const WriteWork& work, WriteDone& done);
  DiskOutcome WriteCheckpoint(const WriteWork& work, WriteDone& done);
  DiskOutcome Forget(const std::string& job);
  DiskOutcome PerformUpload(const coordinator::UploadAction& action, WriteDone& done);
  void Protect(const std::string& job, const std::vector<Hash>& blobs, bool alone);
  void RemoveOld(Checkpoints& checkpoints, const proto::Checkpoint& newest);
  bool IsGood(const CheckpointPtr& checkpoint) const;
  void DamageSomething(const std::string& job, Checkpoints& checkpoints);
  std::optional<coordinator::RestoreJob> RecoverJob(const std::string& job, Checkpoints& checkpoints);

  World& world_;
  std::function<void(const WriteDone&)> tell_;
  std::deque<WriteWork> queue_;
  bool busy_ = false;
  std::uint64_t process_ = 0;
  std::uint64_t next_ticket_ = 1;
  std::optional<std::uint64_t> steps_left_;  // before the process dies
  double full_until_s_ = 0;
  std::uint64_t last_removed_ = 0;  // number of a job
  FolderModel<Hash, bool> blobs_;
  std::map<std::string, Checkpoints> checkpoints_;
  std::map<std::string, FolderModel<std::uint32_t, Hash>> results_;
  std::set<std::uint64_t> failed_uploads_;
  // Blobs of the last two checkpoints of each job that this process wrote or found: they must stay.
  std::map<std::string, std::deque<std::set<Hash>>> protected_;
};

}  // namespace cairn::simulation
