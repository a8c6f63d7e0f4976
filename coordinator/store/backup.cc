#include "coordinator/store/backup.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <optional>
#include <set>
#include <utility>

#include "coordinator/core/round.h"
#include "coordinator/store/blob_files.h"
#include "coordinator/store/checkpoint_file.h"
#include "coordinator/store/cleaner.h"
#include "coordinator/store/folder.h"
#include "coordinator/store/job_table.h"
#include "schema/store/atomic_file.h"
#include "schema/store/blob_file.h"
#include "schema/store/regular_file.h"

namespace cairn::coordinator {
namespace {

namespace fs = std::filesystem;

// A job goes on while it is copied: what its checkpoint named may be gone, for there is a newer one.
constexpr int kTries = 50;

fs::path ResultsIn(const fs::path& store, const std::string& job) { return store / "results" / job; }

class Copier {
 public:
  Copier(const StoreFolder& from, const StoreFolder& to) : from_(from), to_(to) {
    for (const Hash& hash : to.BlobsAlone()) here_.insert(hash);
    for (const fs::path& pack : to.PackFiles()) Index(pack);
  }

  // Not Ok: what no other try mends, of the copy's disk above all.
  Status CopyJob(const std::string& job);
  BackupFacts& facts() { return facts_; }
  const std::set<Hash>& named() const { return named_; }
  // Of jobs that could not be copied, or were before.
  bool all_known() const { return all_known_; }

 private:
  // True where all that it names is here.
  Result<bool> CopyBlobs(const proto::Checkpoint& checkpoint);
  Result<bool> CopyPacks(const Hash& wanted);
  Status CopyResults(const std::string& job);
  // False: there is no such file (any more).
  Result<bool> Copy(const fs::path& source, const fs::path& target);
  bool Index(const fs::path& pack);
  Result<bool> CopyCheckpoint(const proto::Checkpoint& checkpoint, const std::string& job,
                              std::uint64_t number);

  const StoreFolder &from_, &to_;
  std::set<Hash> here_, named_;
  std::set<fs::path> looked_at_;  // packs of `from`
  bool all_known_ = true;
  BackupFacts facts_;
};

bool Copier::Index(const fs::path& pack) {
  const std::optional<std::vector<Hash>> hashes = HashesInPack(pack);
  if (!hashes) return false;
  here_.insert(hashes->begin(), hashes->end());
  return true;
}

// By way of a file that the next owner of the copy removes.
Result<bool> Copier::Copy(const fs::path& source, const fs::path& target) {
  const Result<RegularFile> file = RegularFile::Open(source);
  if (!file.ok() && file.status().code() == Code::kNotFound) return false;
  if (!file.ok()) return file.status();
  const fs::path part = to_.Uploads() / "backup.part";
  const int out = ::open(part.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0600);
  if (out < 0) return SystemFailure(part, "open", errno);
  const auto fail = [&](const fs::path& path, const char* doing, int error) {
    ::close(out);
    std::error_code ignored;
    fs::remove(part, ignored);
    return SystemFailure(path, doing, error);
  };
  std::vector<std::byte> buffer(1 << 20);
  for (std::uint64_t at = 0; at < file.value().size();) {
    const std::size_t count = std::min<std::uint64_t>(buffer.size(), file.value().size() - at);
    const std::span<std::byte> bytes(buffer.data(), count);
    if (const int error = file.value().ReadAt(bytes, at); error != 0) return fail(source, "read", error);
    for (std::size_t done = 0; done < count;) {
      const ssize_t n = ::write(out, bytes.data() + done, count - done);
      if (n < 0 && errno != EINTR) return fail(part, "write", errno);
      if (n > 0) done += static_cast<std::size_t>(n);
    }
    at += count;
  }
  if (::fsync(out) != 0) return fail(part, "fsync", errno);
  ::close(out);
  std::error_code error;
  fs::rename(part, target, error);
  if (error) return SystemFailure(target, "rename", error.value());
  if (Status status = SyncFolder(target.parent_path()); !status.ok()) return status;
  ++facts_.files;
  facts_.bytes += file.value().size();
  return true;
}

// Those that are not here yet, until one has what is wanted.
Result<bool> Copier::CopyPacks(const Hash& wanted) {
  for (const fs::path& pack : from_.PackFiles()) {
    if (here_.contains(wanted)) return true;
    const fs::path target = to_.Blobs() / pack.filename();
    std::error_code error;
    if (!looked_at_.insert(pack).second || fs::exists(target, error)) continue;
    const Result<bool> copied = Copy(pack, target);
    if (!copied.ok()) return copied;
    if (copied.value() && !Index(target)) fs::remove(target, error);
  }
  return here_.contains(wanted);
}

Result<bool> Copier::CopyBlobs(const proto::Checkpoint& checkpoint) {
  // Of a job that is over for good no blob is kept.
  if (checkpoint.state() == proto::JOB_DONE || checkpoint.state() == proto::JOB_CANCELLED) return true;
  for (const std::string& binary : checkpoint.blobs()) {
    const Hash hash = Hash::FromBinary(binary).value();
    if (here_.contains(hash)) continue;
    bool found = false;
    for (const auto& [source, target] : {std::pair(from_.FlatFile(hash), to_.FlatFile(hash)),
                                         std::pair(from_.BlobFile(hash), to_.BlobFile(hash))}) {
      if (found) break;
      const Result<bool> copied = Copy(source, target);
      if (!copied.ok()) return copied;
      found = copied.value();
    }
    if (found) {
      if (const Status whole = CheckBlobAlone(to_, hash); !whole.ok()) {
        std::error_code ignored;
        for (const fs::path& target : {to_.FlatFile(hash), to_.BlobFile(hash)}) fs::remove(target, ignored);
        return Status(whole.code(), "a blob, as it was copied: " + whole.message());
      }
      here_.insert(hash);
      continue;
    }
    const Result<bool> packed = CopyPacks(hash);
    if (!packed.ok() || !packed.value()) return packed;
  }
  return true;
}

// They are published once, and stay as they are.
Status Copier::CopyResults(const std::string& job) {
  std::error_code error;
  for (const fs::path& source : EntriesOf(ResultsIn(from_.dir(), job))) {
    const fs::path target = ResultsIn(to_.dir(), job) / source.filename();
    if (source.extension() != ".h5" || fs::exists(target, error)) continue;
    fs::create_directories(target.parent_path(), error);
    if (error) return SystemFailure(target.parent_path(), "make the folder", error.value());
    const Result<bool> copied = Copy(source, target);
    if (!copied.ok()) return copied.status();
    if (const Result<BlobFile> whole = ReadStoredFile(target); copied.value() && !whole.ok()) {
      fs::remove(target, error);
      facts_.damaged.push_back(source.string() + ", as it was copied: " + whole.status().message());
    }
  }
  return Status::Ok();
}

// With it the copy has the job as it stands, and nothing older is needed.
Result<bool> Copier::CopyCheckpoint(const proto::Checkpoint& checkpoint, const std::string& job,
                                    std::uint64_t number) {
  const fs::path target = to_.CheckpointFile(job, number);
  std::error_code error;
  fs::create_directories(target.parent_path(), error);
  if (error) return SystemFailure(target.parent_path(), "make the folder", error.value());
  const Result<proto::Checkpoint> before = ReadCheckpoint(target);
  if (!before.ok() || HashOfMessage(before.value()) != HashOfMessage(checkpoint)) {
    const Result<bool> copied = Copy(from_.CheckpointFile(job, number), target);
    if (!copied.ok() || !copied.value()) return copied;
  }
  for (const std::uint64_t old : to_.CheckpointNumbers(job))
    if (old != number) fs::remove(to_.CheckpointFile(job, old), error);
  for (const std::string& blob : checkpoint.blobs()) named_.insert(Hash::FromBinary(blob).value());
  ++facts_.jobs;
  return true;
}

Status Copier::CopyJob(const std::string& job) {
  std::string why;
  for (int i = 0; i < kTries; ++i) {
    const std::vector<std::uint64_t> numbers = from_.CheckpointNumbers(job);
    if (numbers.empty()) return Status::Ok();  // it was deleted
    const std::uint64_t number = numbers.back();
    const Result<proto::Checkpoint> checkpoint = ReadCheckpoint(from_.CheckpointFile(job, number));
    looked_at_.clear();
    Result<bool> copied = checkpoint.ok() ? CopyBlobs(checkpoint.value()) : checkpoint.status();
    if (copied.ok() && copied.value()) {
      if (Status status = CopyResults(job); !status.ok()) return status;
      copied = CopyCheckpoint(checkpoint.value(), job, number);
      if (copied.ok() && copied.value()) return Status::Ok();
    }
    why = copied.ok() ? "a blob that its newest checkpoint names is not there" : copied.status().message();
    const Code code = copied.ok() ? Code::kNotFound : copied.status().code();
    if (code != Code::kNotFound && code != Code::kCorrupt) return copied.status();
    // It is damaged, unless there is a newer one by now.
    const std::vector<std::uint64_t> now = from_.CheckpointNumbers(job);
    if (!now.empty() && now.back() == number) break;
  }
  all_known_ = false;
  facts_.damaged.push_back("job " + job + ": " + why);
  return Status::Ok();
}

Status RemoveWhatIsGone(const StoreFolder& from, const StoreFolder& to) {
  const std::vector<std::string> there = from.JobsWithCheckpoints();
  for (const std::string& job : to.JobsWithCheckpoints())
    if (!std::ranges::binary_search(there, job))
      if (Status status = to.Forget(job, ResultsIn(to.dir(), job)); !status.ok()) return status;
  return Status::Ok();
}

Status CopyTableAndClock(const StoreFolder& from, const StoreFolder& to, BackupFacts& facts) {
  const Status table = JobTable::Copy(from.JobTable(), to.JobTable());
  if (!table.ok() && table.code() != Code::kCorrupt && table.code() != Code::kNotFound) return table;
  if (!table.ok()) facts.damaged.push_back("the logs of jobs: " + table.message());
  constexpr std::size_t kMostBytes = 1 << 10;
  const Result<std::string> served = ReadSmallFile(from.ServedFile(), kMostBytes);
  return served.ok() ? WriteTextAtomically(to.ServedFile(), served.value()) : Status::Ok();
}

}  // namespace

Result<BackupFacts> BackUp(const fs::path& from_dir, const fs::path& to_dir) {
  const Result<StoreFolder> from = StoreFolder::LookAt(from_dir);
  if (!from.ok()) return from.status();
  const Result<StoreFolder> to = StoreFolder::Open(to_dir);
  if (!to.ok()) return to.status();
  const std::vector<std::string> jobs = from.value().JobsWithCheckpoints();
  if (jobs.empty() && !to.value().JobsWithCheckpoints().empty())
    return Status(Code::kRefused, from_dir.string() + " has no job, but the copy in " + to_dir.string() +
                                      " has: is it the right store?");
  std::error_code error;
  fs::remove(to_dir / kBackupMark, error);
  if (Status status = SyncFolder(to_dir); !status.ok()) return status;
  Copier copier(from.value(), to.value());
  for (const std::string& job : jobs)
    if (Status status = copier.CopyJob(job); !status.ok()) return status;
  if (Status status = RemoveWhatIsGone(from.value(), to.value()); !status.ok()) return status;
  // Last: no number that a job ever had is given to another.
  if (Status status = CopyTableAndClock(from.value(), to.value(), copier.facts()); !status.ok())
    return status;
  if (copier.all_known()) BlobFiles(to.value()).RemoveAllBut(copier.named());
  if (copier.facts().damaged.empty())
    if (Status status =
            WriteTextAtomically(to_dir / kBackupMark, std::to_string(copier.facts().jobs) + " jobs\n");
        !status.ok())
      return status;
  return std::move(copier.facts());
}

}  // namespace cairn::coordinator
