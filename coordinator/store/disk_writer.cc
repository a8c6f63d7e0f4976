#include "coordinator/store/disk_writer.h"

#include <algorithm>
#include <utility>

#include "coordinator/store/checkpoint_file.h"
#include "coordinator/store/recovery.h"
#include "coordinator/store/result_file.h"
#include "coordinator/store/served_file.h"
#include "schema/kinds/kind.h"
#include "schema/store/atomic_file.h"
#include "schema/store/blob_file.h"

namespace cairn::coordinator {

namespace fs = std::filesystem;

namespace {

constexpr std::chrono::seconds kCountEvery{5};

std::uint64_t BytesOf(const std::vector<wire::NamedBlob>& blobs) {
  std::uint64_t bytes = 0;
  for (const wire::NamedBlob& named : blobs) bytes += named.blob == nullptr ? 0 : named.blob->ByteCount();
  return bytes;
}

// With those above it. Durable when it returns: a file in it is only as safe as its folder's name.
Status MakeFolder(const fs::path& folder) {
  std::error_code error;
  if (folder.empty() || fs::is_directory(folder, error)) return Status::Ok();
  if (Status above = MakeFolder(folder.parent_path()); !above.ok()) return above;
  fs::create_directory(folder, error);
  if (error) return SystemFailure(folder, "make the folder", error.value());
  Status synced = SyncFolder(folder.has_parent_path() ? folder.parent_path() : fs::path("."));
  if (!synced.ok()) fs::remove(folder, error);
  return synced;
}

}  // namespace

DiskWriter::DiskWriter(const StoreFolder& folder, BlobFiles& files, StoreUse& use, JobTable table,
                       std::function<void()> wake)
    : folder_(folder),
      files_(files),
      use_(use),
      table_(std::move(table)),
      uploads_(folder, use, files),
      wake_(std::move(wake)),
      thread_([this] { Loop(); }) {}

DiskWriter::~DiskWriter() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    std::erase_if(queue_, [](const Item& item) {  // nobody is there for the answers
      return std::holds_alternative<ReadLogWork>(item.work) || std::holds_alternative<CleanWork>(item.work) ||
             std::holds_alternative<LoadWork>(item.work);
    });
  }
  changed_.notify_one();
  thread_.join();
  if (!folder_.TakenOver().empty()) table_.LeaveAsItIs();
}

std::uint64_t DiskWriter::Add(DiskWork work) {
  const std::uint64_t ticket = next_ticket_++;
  {
    const std::lock_guard lock(mutex_);
    queue_.push_back({ticket, std::move(work)});
  }
  changed_.notify_one();
  return ticket;
}

std::vector<DiskDone> DiskWriter::TakeDone() {
  const std::lock_guard lock(mutex_);
  return std::exchange(done_, {});
}

bool DiskWriter::Finished(std::uint64_t ticket) {
  const std::lock_guard lock(mutex_);
  return finished_ >= ticket;
}

std::optional<DiskWriter::Item> DiskWriter::Next() {
  const auto something = [this] { return closed_ || !queue_.empty(); };
  std::unique_lock lock(mutex_);
  if (!changed_.wait_until(lock, count_at_, something) || std::chrono::steady_clock::now() >= count_at_) {
    lock.unlock();
    use_.Count();
    count_at_ = std::chrono::steady_clock::time_point::max();
    lock.lock();
    changed_.wait(lock, something);
  }
  if (queue_.empty()) return std::nullopt;
  Item item = std::move(queue_.front());
  queue_.pop_front();
  return item;
}

void DiskWriter::Loop() {
  while (std::optional<Item> item = Next()) {
    std::optional<DiskDone> done = Do(*item);
    count_at_ = std::min(count_at_, std::chrono::steady_clock::now() + kCountEvery);
    {
      const std::lock_guard lock(mutex_);
      finished_ = item->ticket;
      if (done) done_.push_back(std::move(*done));
    }
    if (done) wake_();
  }
}

// What nobody waits for is told only where it failed.
std::optional<DiskDone> DiskWriter::Do(Item& item) {
  DiskDone done = std::visit([this](auto& work) { return Do(work); }, item.work);
  done.ticket = item.ticket;
  const bool silent = done.job.empty() && done.asker.empty() && done.written.empty() && done.upload == 0 &&
                      done.loaded.empty() && done.read.empty() &&
                      !std::holds_alternative<WriteServedWork>(item.work);
  if (silent && done.status.ok()) return std::nullopt;
  return done;
}

DiskDone DiskWriter::Do(WriteCheckpointWork& work) {
  const proto::Checkpoint& checkpoint = work.checkpoint;
  DiskDone done;
  done.job = checkpoint.job_id();
  done.number = checkpoint.number();
  std::uint64_t bytes = BytesOf(work.blobs);
  for (ResultToWrite& result : work.results) {
    if (result.blob == nullptr) {
      Result<BlobPtr> read = files_.ReadOwnFile(result.hash);
      done.status = read.status();
      if (!read.ok()) return done;
      result.blob = std::move(read).value();
    }
    bytes += result.blob->ByteCount();
  }
  // A record alone always fits, and so does what a cancelled job leaves: it makes room.
  done.status = folder_.MayWriteCheckpoints(checkpoint.job_id());
  if (done.status.ok() && bytes > 0 && checkpoint.state() != proto::JOB_CANCELLED)
    done.status = use_.Reserve(bytes);
  if (done.status.ok()) done.status = files_.Write(work.blobs, done.written);
  // Asked again before what others read: a machine that stood still meanwhile may have lost the store.
  for (const ResultToWrite& result : work.results) {
    if (done.status.ok()) done.status = folder_.IsStillThere();
    if (done.status.ok()) done.status = MakeFolder(result.path.parent_path());
    if (!done.status.ok()) return done;
    done.status = WriteBlobFile(result.path, KindOf(*result.blob),
                                WithProvenance(*result.blob, checkpoint, result.stage, UtcNow()));
  }
  if (!done.status.ok()) return done;
  const fs::path path = folder_.CheckpointFile(checkpoint.job_id(), checkpoint.number());
  std::error_code ignored;
  done.status = MakeFolder(path.parent_path());
  if (done.status.ok()) done.status = folder_.IsStillThere();
  if (!done.status.ok()) return done;
  done.status = WriteCheckpoint(path, checkpoint);
  if (done.status.ok()) {
    RemoveOldCheckpoints(checkpoint);
    static_cast<void>(table_.NoteNumber(checkpoint.job_id()));  // the checkpoint tells it too
  } else {
    // Whole perhaps, but not known to be durable: the core forgets its blobs, so it must not be counted on.
    fs::remove(path, ignored);
  }
  return done;
}

DiskDone DiskWriter::Do(const WriteBlobsWork& work) const {
  DiskDone done;
  done.status = folder_.IsStillThere();
  if (done.status.ok()) done.status = use_.Reserve(BytesOf(work.blobs));
  if (done.status.ok()) done.status = files_.Write(work.blobs, done.written);
  return done;
}

void DiskWriter::RemoveOldCheckpoints(const proto::Checkpoint& checkpoint) const {
  const bool final = checkpoint.state() == proto::JOB_DONE || checkpoint.state() == proto::JOB_CANCELLED;
  const std::size_t keep = final ? 1 : 2;  // its record alone
  const std::vector<std::uint64_t> numbers = folder_.CheckpointNumbers(checkpoint.job_id());
  for (std::size_t i = 0; i + keep < numbers.size(); ++i) {
    if (!folder_.IsStillThere().ok()) return;
    std::error_code ignored;  // an old checkpoint too many does no harm
    fs::remove(folder_.CheckpointFile(checkpoint.job_id(), numbers[i]), ignored);
  }
}

DiskDone DiskWriter::Do(const WriteServedWork& work) const {
  DiskDone done;
  done.status = folder_.IsStillThere();
  if (done.status.ok()) done.status = WriteServed(folder_.ServedFile(), work.served_s);
  return done;
}

// Between two writes, so that nothing is half-written.
DiskDone DiskWriter::Do(const CleanWork& work) const {
  if (const Status there = folder_.IsStillThere(); !there.ok()) {
    DiskDone refused;
    refused.asker = work.asker;
    refused.answer.set_message(there.message());
    return refused;
  }
  const Cleaned cleaned =
      CleanStore(folder_, work.options, [this](const fs::path& pack) { return files_.InPack(pack); });
  files_.ForgetGonePacks();
  DiskDone done;
  done.asker = work.asker;
  done.answer.set_ok(true);
  done.answer.set_message(cleaned.note);
  done.answer.mutable_cleaned()->Assign(cleaned.removed.begin(), cleaned.removed.end());
  return done;
}

DiskDone DiskWriter::Do(const ForgetWork& work) {
  DiskDone done;
  done.job = work.job;
  done.status = folder_.IsStillThere();
  if (done.status.ok()) done.status = table_.NoteRemoval(work.job);
  if (done.status.ok()) done.status = folder_.Forget(work.job, work.results);
  return done;
}

DiskDone DiskWriter::Do(const RemoveBlobsWork& work) {
  if (!folder_.IsStillThere().ok()) return {};
  if (may_have_lost_jobs_) {
    const Result<std::vector<std::string>> lost = LostJobs(folder_);
    may_have_lost_jobs_ = !lost.ok() || !lost.value().empty();
  }
  // What they need nobody knows.
  if (!may_have_lost_jobs_) files_.Remove(work.hashes);
  return {};
}

DiskDone DiskWriter::Do(const WriteLogWork& work) {
  DiskDone done;
  done.status = folder_.IsStillThere();
  if (done.status.ok()) done.status = table_.AppendLog(work.by_job);
  return done;
}

DiskDone DiskWriter::Do(const OpenUpload& work) {
  DiskDone done;
  done.status = uploads_.Do(work);
  if (!done.status.ok()) done.upload = work.id;
  return done;
}

DiskDone DiskWriter::Do(const WritePiece& work) {
  DiskDone done;
  done.upload = work.id;
  done.upload_bytes = work.data.size();
  done.status = uploads_.Do(work);
  return done;
}

DiskDone DiskWriter::Do(const CloseUpload& work) {
  DiskDone done;
  const Status closed = uploads_.Do(work);
  if (!work.whole) return done;
  done.upload = work.id;
  done.closed = true;
  done.blob = work.hash;
  done.status = closed;
  return done;
}

DiskDone DiskWriter::Do(const LoadWork& work) const {
  DiskDone done;
  for (const Hash& hash : work.blobs) done.read.emplace(hash, files_.ReadOwnFile(hash));
  for (const fs::path& file : work.files) done.loaded.push_back(SharedResults::Load(file));
  return done;
}

DiskDone DiskWriter::Do(const ReadLogWork& work) const {
  DiskDone done;
  done.asker = work.asker;
  const Result<std::vector<wire::LogLine>> lines = table_.ReadLog(work.job.id(), work.after);
  done.answer.set_ok(lines.ok());
  if (!lines.ok()) {
    done.answer.set_message(lines.status().message());
    return done;
  }
  *done.answer.add_jobs() = work.job;
  done.answer.mutable_log()->Assign(lines.value().begin(), lines.value().end());
  return done;
}

}  // namespace cairn::coordinator
