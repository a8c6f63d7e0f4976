#include "tests/simulation/store_model.h"

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

#include "tests/simulation/world.h"

namespace cairn::simulation {

using coordinator::Publish;
using coordinator::RestoreJob;

namespace {

std::vector<Hash> BlobsOf(const proto::Checkpoint& checkpoint) {
  std::vector<Hash> blobs;
  for (const std::string& blob : checkpoint.blobs()) blobs.push_back(Hash::FromBinary(blob).value());
  return blobs;
}

bool IsFinal(const proto::Checkpoint& checkpoint) {
  return checkpoint.state() == proto::JOB_DONE || checkpoint.state() == proto::JOB_CANCELLED;
}

}  // namespace

void StoreModel::Add(WriteWork work) {
  work.ticket = next_ticket_++;
  queue_.push_back(std::move(work));
  BeginNext();
}

void StoreModel::BeginNext() {
  if (busy_ || queue_.empty()) return;
  busy_ = true;
  const double takes_s =
      queue_.front().persist ? world_.rng.Uniform(0.0005, world_.faults.persist_s) : 0.0002;
  world_.schedule.After(takes_s, [this, process = process_] {
    if (process != process_) return;
    const WriteWork work = std::move(queue_.front());
    queue_.pop_front();
    busy_ = false;
    WriteDone done;
    Perform(work, done);
    BeginNext();
    if (work.persist || done.forgotten || done.upload > 0) tell_(done);
  });
}

// What was under way gets as far as chance will have it.
void StoreModel::EndProcess(bool power_cut) {
  ++process_;
  if (busy_) {
    const WriteWork& work = queue_.front();
    const std::size_t files = work.blobs.size() + (work.persist  ? work.persist->publish.size() + 1
                                                   : work.upload ? 1
                                                                 : 0);
    steps_left_ = world_.rng.Below(4 * files + work.remove.size() + 2);
    WriteDone done;
    const bool whole = Perform(work, done) == DiskOutcome::kOk;
    steps_left_.reset();
    if (work.persist) world_.Count(whole ? kDurableUntold : kCoordinatorKilledWriting);
  }
  queue_.clear();
  failed_uploads_.clear();
  busy_ = false;
  if (!power_cut) return;
  const auto keeps = [this] {
    const bool kept = world_.rng.Below(2) == 0;
    world_.Count(kept ? kUnsyncedKept : kUnsyncedLost);
    return kept;
  };
  blobs_.CutPower(keeps);
  for (auto& [job, checkpoints] : checkpoints_) checkpoints.CutPower(keeps);
  for (auto& [job, results] : results_) results.CutPower(keeps);
}

DiskOutcome StoreModel::Step(DiskStep step) {
  if (steps_left_ && (*steps_left_)-- == 0) {
    steps_left_ = 0;
    return DiskOutcome::kDead;
  }
  if (step == DiskStep::kWrite && world_.schedule.now_s() < full_until_s_) {
    world_.Count(kDiskFull);
    return DiskOutcome::kFailed;
  }
  const bool sync = step == DiskStep::kSyncFile || step == DiskStep::kSyncFolder;
  if (!sync || !world_.Chance(world_.faults.sync_fails)) return DiskOutcome::kOk;
  world_.Count(step == DiskStep::kSyncFile ? kSyncFailed : kFolderSyncFailed);
  return DiskOutcome::kFailed;
}

DiskOutcome StoreModel::Perform(const WriteWork& work, WriteDone& done) {
  done.ticket = work.ticket;
  if (work.persist) {
    done.job = work.persist->checkpoint.job_id();
    done.number = work.persist->checkpoint.number();
    const DiskOutcome outcome = WriteCheckpoint(work, done);
    if (outcome == DiskOutcome::kFailed) done.problem = "the disk fails";
    return outcome;
  }
  if (!work.forget.empty()) {
    done.job = work.forget;
    done.forgotten = true;
    const DiskOutcome outcome = Forget(work.forget);
    if (outcome == DiskOutcome::kFailed) done.problem = "the disk fails";
    return outcome;
  }
  if (work.upload) return PerformUpload(*work.upload, done);
  for (const Hash& hash : work.remove) {
    if (Step(DiskStep::kRemove) != DiskOutcome::kOk) return DiskOutcome::kDead;
    blobs_.Remove(hash);
    for (const auto& [job, kept] : protected_)
      for (const std::set<Hash>& blobs : kept)
        if (blobs.contains(hash))
          world_.checks.Fail("a blob is removed that a checkpoint of " + job + " needs");
  }
  return DiskOutcome::kOk;
}

// UploadFiles: what has failed once goes on failing.
DiskOutcome StoreModel::PerformUpload(const coordinator::UploadAction& action, WriteDone& done) {
  const auto outcome_of = [&](std::uint64_t id, DiskOutcome outcome) {
    if (outcome == DiskOutcome::kFailed) failed_uploads_.insert(id);
    if (failed_uploads_.contains(id)) done.problem = "the disk fails";
    return outcome;
  };
  if (const auto* open = std::get_if<coordinator::OpenUpload>(&action)) {
    const DiskOutcome outcome = outcome_of(open->id, Step(DiskStep::kWrite));
    if (outcome == DiskOutcome::kFailed) done.upload = open->id;
    return outcome;
  }
  if (const auto* piece = std::get_if<coordinator::WritePiece>(&action)) {
    done.upload = piece->id;
    done.upload_bytes = piece->data.size();
    return outcome_of(piece->id, Step(DiskStep::kWrite));
  }
  const auto& close = std::get<coordinator::CloseUpload>(action);
  const bool failed = failed_uploads_.erase(close.id) > 0;
  if (!close.whole) return DiskOutcome::kOk;
  done.upload = close.id;
  done.closed = true;
  done.blob = close.hash;
  DiskOutcome outcome = DiskOutcome::kFailed;
  if (!failed) outcome = blobs_.Write(close.hash, true, [this](DiskStep step) { return Step(step); });
  if (outcome == DiskOutcome::kFailed && !failed) blobs_.Remove(close.hash);
  if (outcome == DiskOutcome::kFailed) done.problem = "the disk fails";
  return outcome;
}

std::uint64_t StoreModel::QueuedBytes() const {
  std::uint64_t bytes = 0;
  for (const WriteWork& work : queue_)
    if (work.upload)
      if (const auto* piece = std::get_if<coordinator::WritePiece>(&*work.upload))
        bytes += piece->data.size();
  return bytes;
}

// A job's number first, so that it is not given to another; then the folder is renamed, and that synced.
DiskOutcome StoreModel::Forget(const std::string& job) {
  if (const DiskOutcome outcome = Step(DiskStep::kWrite); outcome != DiskOutcome::kOk) return outcome;
  if (const proto::Checkpoint* newest = Newest(job); newest != nullptr)
    last_removed_ = std::max(last_removed_, NumberOf(newest->job()));
  if (const DiskOutcome outcome = Step(DiskStep::kRename); outcome != DiskOutcome::kOk) return outcome;
  if (const DiskOutcome outcome = Step(DiskStep::kSyncFolder); outcome != DiskOutcome::kOk) return outcome;
  checkpoints_.erase(job);
  results_.erase(job);
  protected_.erase(job);
  return DiskOutcome::kOk;
}

// The order of disk_writer.cc: blobs, results, the checkpoint, then older ones go.
DiskOutcome StoreModel::WriteCheckpoint(const WriteWork& work, WriteDone& done) {
  const DiskSteps steps = [this](DiskStep step) { return Step(step); };
  const proto::Checkpoint& checkpoint = work.persist->checkpoint;
  for (const Hash& blob : work.blobs) {
    if (const auto outcome = blobs_.Write(blob, true, steps); outcome != DiskOutcome::kOk) return outcome;
    done.written.push_back(blob);
  }
  for (const Publish& publish : work.persist->publish) {
    const auto outcome = results_[done.job].Write(publish.stage, publish.result, steps);
    if (outcome != DiskOutcome::kOk) return outcome;
    world_.checks.SeeResult(done.job, publish.stage, publish.result);
  }
  Checkpoints& checkpoints = checkpoints_[done.job];
  const auto outcome =
      checkpoints.Write(checkpoint.number(), std::make_shared<const proto::Checkpoint>(checkpoint), steps);
  if (outcome == DiskOutcome::kFailed) checkpoints.Remove(checkpoint.number());
  if (outcome != DiskOutcome::kOk) return outcome;
  world_.checks.SeeDurable(checkpoint);
  Protect(done.job, BlobsOf(checkpoint), IsFinal(checkpoint));
  RemoveOld(checkpoints, checkpoint);
  return DiskOutcome::kOk;
}

void StoreModel::Protect(const std::string& job, const std::vector<Hash>& blobs, bool alone) {
  std::deque<std::set<Hash>>& kept = protected_[job];
  if (alone) kept.clear();
  kept.emplace_back(blobs.begin(), blobs.end());
  if (kept.size() > 2) kept.pop_front();
}

void StoreModel::RemoveOld(Checkpoints& checkpoints, const proto::Checkpoint& newest) {
  const std::size_t keep = IsFinal(newest) ? 1 : 2;
  while (checkpoints.files().size() > keep) {
    if (Step(DiskStep::kRemove) != DiskOutcome::kOk) return;
    checkpoints.Remove(checkpoints.files().begin()->first);
  }
}

bool StoreModel::IsGood(const CheckpointPtr& checkpoint) const {
  const std::vector<Hash> blobs = BlobsOf(*checkpoint);
  return std::all_of(blobs.begin(), blobs.end(), [this](const Hash& blob) { return Has(blob); });
}

// The newest checkpoint or a blob that only it names, where the one before would do.
void StoreModel::DamageSomething(const std::string& job, Checkpoints& checkpoints) {
  if (checkpoints.files().size() != 2 || !world_.Chance(world_.faults.damaged)) return;
  const auto before = checkpoints.files().begin(), newest = std::next(before);
  if (before->second.torn || newest->second.torn || !IsGood(before->second.content)) return;
  const std::vector<Hash> shared = BlobsOf(*before->second.content);
  const std::uint64_t number = newest->first;
  for (const Hash& blob : BlobsOf(*newest->second.content)) {
    if (world_.rng.Below(3) != 0 || std::find(shared.begin(), shared.end(), blob) != shared.end()) continue;
    if (std::any_of(checkpoints_.begin(), checkpoints_.end(), [&](const auto& other) {
          if (other.first == job) return false;
          for (const auto& [n, file] : other.second.files())
            for (const Hash& theirs : BlobsOf(*file.content))
              if (theirs == blob) return true;
          return false;
        }))
      continue;
    world_.Say("a blob of the last checkpoint of " + job + " is damaged");
    world_.Count(kBlobDamaged);
    blobs_.Damage(blob);
    return world_.checks.SeeDamaged(*before->second.content);
  }
  world_.Say("the last checkpoint of " + job + " is damaged");
  world_.Count(kCheckpointDamaged);
  world_.checks.SeeDamaged(*before->second.content);
  checkpoints.Damage(number);
}

std::optional<RestoreJob> StoreModel::RecoverJob(const std::string& job, Checkpoints& checkpoints) {
  std::optional<RestoreJob> restore;
  std::vector<std::uint64_t> numbers;
  for (const auto& [number, file] : checkpoints.files()) numbers.push_back(number);
  while (!numbers.empty()) {
    const CheckpointPtr* checkpoint = checkpoints.Read(numbers.back());
    if (restore) {
      if (checkpoint == nullptr) return restore;
      for (const Hash& blob : BlobsOf(**checkpoint))
        if (Has(blob)) restore->previous_blobs.push_back(blob);
      return restore;
    }
    if (checkpoint != nullptr && IsGood(*checkpoint)) {
      restore = RestoreJob{**checkpoint, {}};
    } else {
      world_.Say("quarantined checkpoint " + std::to_string(numbers.back()) + " of " + job);
      world_.Count(kQuarantined);
      checkpoints.Remove(numbers.back());
    }
    numbers.pop_back();
  }
  if (!restore) world_.checks.SeeLost(job);
  return restore;
}

std::vector<RestoreJob> StoreModel::Recover() {
  std::vector<RestoreJob> jobs;
  std::set<Hash> named;
  protected_.clear();
  blobs_.SyncFolder();
  for (auto& [job, checkpoints] : checkpoints_) checkpoints.SyncFolder();
  for (auto& [job, checkpoints] : checkpoints_) {
    DamageSomething(job, checkpoints);
    if (checkpoints.files().empty()) continue;
    std::optional<RestoreJob> restore = RecoverJob(job, checkpoints);
    if (!restore) continue;
    for (const Hash& blob : BlobsOf(restore->checkpoint)) named.insert(blob);
    named.insert(restore->previous_blobs.begin(), restore->previous_blobs.end());
    Protect(job, restore->previous_blobs, true);
    Protect(job, BlobsOf(restore->checkpoint), IsFinal(restore->checkpoint));
    jobs.push_back(std::move(*restore));
  }
  std::vector<Hash> unnamed;
  for (const auto& [blob, file] : blobs_.files())
    if (!named.contains(blob)) unnamed.push_back(blob);
  for (const Hash& blob : unnamed) blobs_.Remove(blob);
  std::sort(jobs.begin(), jobs.end(), [](const RestoreJob& a, const RestoreJob& b) {
    return std::tuple(a.checkpoint.order(), a.checkpoint.job_id()) <
           std::tuple(b.checkpoint.order(), b.checkpoint.job_id());
  });
  return jobs;
}

std::uint64_t StoreModel::LastNumber() const {
  std::uint64_t last = last_removed_;
  for (const auto& [job, checkpoints] : checkpoints_)
    for (const auto& [number, file] : checkpoints.files())
      last = std::max(last, NumberOf(file.content->job()));
  return last;
}

const proto::Checkpoint* StoreModel::Newest(const std::string& job) const {
  const auto it = checkpoints_.find(job);
  if (it == checkpoints_.end() || it->second.files().empty()) return nullptr;
  return it->second.files().rbegin()->second.content.get();
}

}  // namespace cairn::simulation
