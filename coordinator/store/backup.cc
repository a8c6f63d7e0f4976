#include "coordinator/store/backup.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <functional>
#include <optional>
#include <set>
#include <utility>

#include "coordinator/core/round.h"
#include "coordinator/store/blob_files.h"
#include "coordinator/store/checkpoint_file.h"
#include "coordinator/store/cleaner.h"
#include "coordinator/store/folder.h"
#include "coordinator/store/job_table.h"
#include "coordinator/store/recovery.h"
#include "coordinator/store/store_id.h"
#include "schema/store/atomic_file.h"
#include "schema/store/blob_file.h"
#include "schema/store/regular_file.h"

namespace cairn::coordinator {
namespace {

namespace fs = std::filesystem;

// A job goes on while it is copied: what its checkpoint named may be gone, for there is a newer one.
constexpr int kTries = 50;

// The same in size and checksum trailer, which tells what is in it.
bool LooksTheSame(const fs::path& a, const fs::path& b) {
  constexpr std::uint64_t kTail = 64;
  const Result<RegularFile> one = RegularFile::Open(a), other = RegularFile::Open(b);
  if (!one.ok() || !other.ok() || one.value().size() != other.value().size()) return false;
  const std::uint64_t size = one.value().size(), tail = std::min(size, kTail);
  std::array<std::vector<std::byte>, 2> ends{std::vector<std::byte>(tail), std::vector<std::byte>(tail)};
  return one.value().ReadAt(ends[0], size - tail) == 0 && other.value().ReadAt(ends[1], size - tail) == 0 &&
         ends[0] == ends[1];
}

// What came of a file of the store; of the copy's own disk a Status says it.
struct Copied {
  enum What { kDone, kGone, kUnreadable } what = kDone;
  std::string why = {};  // it is unreadable
};

Status IsWhole(const fs::path& result) { return ReadStoredFile(result).status(); }

fs::path ResultsIn(const fs::path& store, const std::string& job) { return store / "results" / job; }

class Copier {
 public:
  Copier(const StoreFolder& from, const StoreFolder& to, bool check) : from_(from), to_(to), check_(check) {
    for (const Hash& hash : to.BlobsAlone()) here_.insert(hash);
    for (const fs::path& pack : to.PackFiles()) Index(pack);
  }

  // Not Ok: the copy's own disk does not take it.
  Status CopyJob(const std::string& job);
  BackupFacts& facts() { return facts_; }
  const std::set<Hash>& named() const { return named_; }
  // Of each job that the copy has what it needs.
  bool all_known() const { return all_known_; }
  void KeepWhatItHad(const std::string& why) {
    all_known_ = false;
    facts_.damaged.push_back(why);
  }

 private:
  // kDone: all that it names is here.
  Result<Copied> CopyBlobs(const proto::Checkpoint& checkpoint);
  Result<Copied> CopyBlob(const Hash& hash);
  Result<Copied> CopyPacks(const Hash& wanted);
  Status CopyResults(const proto::Checkpoint& checkpoint);
  Result<Copied> CopyCheckpoint(const proto::Checkpoint& checkpoint, std::uint64_t number);
  Result<Copied> Copy(const fs::path& source, const fs::path& target,
                      const std::function<Status(const fs::path&)>& check = nullptr);
  bool Index(const fs::path& pack);

  const StoreFolder &from_, &to_;
  const bool check_;
  std::set<Hash> here_, named_;
  std::set<fs::path> whole_packs_;  // of the copy
  bool all_known_ = true;
  BackupFacts facts_;
};

bool Copier::Index(const fs::path& pack) {
  const std::optional<std::vector<Hash>> hashes = HashesInPack(pack);
  if (!hashes) return false;
  here_.insert(hashes->begin(), hashes->end());
  whole_packs_.insert(pack);
  return true;
}

// By way of a file that the next owner of the copy removes. `check`: of that file, before it takes the place
// of what was there.
Result<Copied> Copier::Copy(const fs::path& source, const fs::path& target,
                            const std::function<Status(const fs::path&)>& check) {
  const Result<RegularFile> file = RegularFile::Open(source);
  if (!file.ok() && file.status().code() == Code::kNotFound) return Copied{Copied::kGone};
  if (!file.ok()) return Copied{Copied::kUnreadable, file.status().message()};
  const fs::path part = to_.Uploads() / "backup.part";
  const int out = ::open(part.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0600);
  if (out < 0) return SystemFailure(part, "open", errno);
  const auto end = [&](auto result) {
    ::close(out);
    std::error_code ignored;
    fs::remove(part, ignored);
    return Result<Copied>(std::move(result));
  };
  std::vector<std::byte> buffer(1 << 20);
  for (std::uint64_t at = 0; at < file.value().size();) {
    const std::size_t count = std::min<std::uint64_t>(buffer.size(), file.value().size() - at);
    const std::span<std::byte> bytes(buffer.data(), count);
    if (const int error = file.value().ReadAt(bytes, at); error != 0)
      return end(Copied{Copied::kUnreadable, SystemFailure(source, "read", error).message()});
    for (std::size_t done = 0; done < count;) {
      const ssize_t n = ::write(out, bytes.data() + done, count - done);
      if (n < 0 && errno != EINTR) return end(SystemFailure(part, "write", errno));
      if (n > 0) done += static_cast<std::size_t>(n);
    }
    at += count;
  }
  if (::fsync(out) != 0) return end(SystemFailure(part, "fsync", errno));
  if (const Status whole = check ? check(part) : Status::Ok(); !whole.ok())
    return end(Copied{Copied::kUnreadable, source.string() + ", as it was copied: " + whole.message()});
  ::close(out);
  std::error_code error;
  fs::rename(part, target, error);
  if (error) return SystemFailure(target, "rename", error.value());
  if (Status status = SyncFolder(target.parent_path()); !status.ok()) return status;
  ++facts_.files;
  facts_.bytes += file.value().size();
  return Copied{};
}

// Those that are not here yet, or are damaged here, until one has what is wanted.
Result<Copied> Copier::CopyPacks(const Hash& wanted) {
  Copied missing{Copied::kGone};
  for (const fs::path& pack : from_.PackFiles()) {
    if (here_.contains(wanted)) return Copied{};
    const fs::path target = to_.Blobs() / pack.filename();
    if (whole_packs_.contains(target)) continue;
    const Result<Copied> copied = Copy(pack, target);
    if (!copied.ok()) return copied;
    if (copied.value().what == Copied::kUnreadable) missing = copied.value();
    if (copied.value().what != Copied::kDone || Index(target)) continue;
    std::error_code error;
    fs::remove(target, error);
    missing = {Copied::kUnreadable, pack.string() + ", as it was copied, is damaged"};
  }
  return here_.contains(wanted) ? Copied{} : missing;
}

Result<Copied> Copier::CopyBlob(const Hash& hash) {
  for (const auto& [source, target] : {std::pair(from_.FlatFile(hash), to_.FlatFile(hash)),
                                       std::pair(from_.BlobFile(hash), to_.BlobFile(hash))}) {
    Result<Copied> copied = Copy(source, target);
    if (!copied.ok() || copied.value().what == Copied::kUnreadable) return copied;
    if (copied.value().what == Copied::kGone) continue;
    const Status whole = CheckBlobAlone(to_, hash);
    if (whole.ok()) {
      here_.insert(hash);
      return copied;
    }
    std::error_code ignored;
    fs::remove(target, ignored);
    return Copied{Copied::kUnreadable, "a blob, as it was copied: " + whole.message()};
  }
  return CopyPacks(hash);
}

Result<Copied> Copier::CopyBlobs(const proto::Checkpoint& checkpoint) {
  // Of a job that is over for good no blob is kept.
  if (checkpoint.state() == proto::JOB_DONE || checkpoint.state() == proto::JOB_CANCELLED) return Copied{};
  std::error_code none;
  for (const std::string& binary : checkpoint.blobs()) {
    const Hash hash = Hash::FromBinary(binary).value();
    const bool alone = fs::exists(to_.FlatFile(hash), none) || fs::exists(to_.BlobFile(hash), none);
    if (here_.contains(hash) && !(check_ && alone && !CheckBlobAlone(to_, hash).ok())) continue;
    Result<Copied> copied = CopyBlob(hash);
    if (!copied.ok() || copied.value().what != Copied::kDone) return copied;
  }
  return Copied{};
}

// They are published once, and stay as they are.
Status Copier::CopyResults(const proto::Checkpoint& checkpoint) {
  const std::string& job = checkpoint.job_id();
  const fs::path folder = ResultsIn(to_.dir(), job);
  std::error_code error;
  for (const fs::path& linked : {folder.parent_path(), folder})
    if (fs::is_symlink(linked, error))
      return {Code::kRefused, linked.string() + " is a link; a copy keeps its results in its own folder"};
  for (int i = 0; i < std::min(checkpoint.results_size(), checkpoint.job().stages_size()); ++i) {
    const std::string& stage = checkpoint.job().stages(i).name();
    const fs::path source = ResultsIn(from_.dir(), job) / (stage + ".h5"),
                   target = folder / source.filename();
    if (LooksTheSame(source, target) && !(check_ && !(IsWhole(source).ok() && IsWhole(target).ok())))
      continue;
    fs::create_directories(folder, error);
    if (error) return SystemFailure(folder, "make the folder", error.value());
    const Result<Copied> copied = Copy(source, target, IsWhole);
    if (!copied.ok()) return copied.status();
    std::string why = copied.value().why;
    if (copied.value().what == Copied::kGone)
      why = source.string() + " is not there, though the stage is done";
    if (!why.empty()) facts_.damaged.push_back("job " + job + ": " + why);
  }
  return Status::Ok();
}

// With it the copy has the job as it stands, and nothing older is needed.
Result<Copied> Copier::CopyCheckpoint(const proto::Checkpoint& checkpoint, std::uint64_t number) {
  const std::string& job = checkpoint.job_id();
  const fs::path target = to_.CheckpointFile(job, number);
  std::error_code error;
  fs::create_directories(target.parent_path(), error);
  if (error) return SystemFailure(target.parent_path(), "make the folder", error.value());
  const Result<proto::Checkpoint> before = ReadCheckpoint(target);
  if (!before.ok() || HashOfMessage(before.value()) != HashOfMessage(checkpoint)) {
    Result<Copied> copied = Copy(from_.CheckpointFile(job, number), target);
    if (!copied.ok() || copied.value().what != Copied::kDone) return copied;
  }
  for (const std::uint64_t old : to_.CheckpointNumbers(job))
    if (old != number) fs::remove(to_.CheckpointFile(job, old), error);
  for (const std::string& blob : checkpoint.blobs()) named_.insert(Hash::FromBinary(blob).value());
  ++facts_.jobs;
  return Copied{};
}

Status Copier::CopyJob(const std::string& job) {
  std::string why;
  for (int i = 0; i < kTries; ++i) {
    const std::vector<std::uint64_t> numbers = from_.CheckpointNumbers(job);
    if (numbers.empty()) return Status::Ok();  // it was deleted
    const std::uint64_t number = numbers.back();
    const Result<proto::Checkpoint> checkpoint = ReadCheckpoint(from_.CheckpointFile(job, number));
    Result<Copied> copied = Copied{Copied::kUnreadable, checkpoint.status().message()};
    if (checkpoint.ok() && checkpoint.value().job_id() != job)
      copied = Copied{Copied::kUnreadable, "its newest checkpoint is of job " + checkpoint.value().job_id()};
    else if (checkpoint.ok())
      copied = CopyBlobs(checkpoint.value());
    if (copied.ok() && copied.value().what == Copied::kDone) {
      if (Status status = CopyResults(checkpoint.value()); !status.ok()) return status;
      copied = CopyCheckpoint(checkpoint.value(), number);
    }
    if (!copied.ok()) return copied.status();
    if (copied.value().what == Copied::kDone) return Status::Ok();
    why = copied.value().what == Copied::kGone ? "a blob that its newest checkpoint names is not there"
                                               : copied.value().why;
    // It is damaged, unless there is a newer one by now.
    const std::vector<std::uint64_t> now = from_.CheckpointNumbers(job);
    if (!now.empty() && now.back() == number) break;
  }
  KeepWhatItHad("job " + job + ": " + why);
  return Status::Ok();
}

// What was deleted there; a job that has lost its checkpoints is none of these. Whoever deletes one removes
// its log before them: looked for in this order, a job that is being deleted is not taken for lost.
Status RemoveWhatIsGone(const StoreFolder& from, const StoreFolder& to, Copier& copier) {
  std::set<std::string> gone;
  std::error_code error;
  for (const std::string& job : to.JobsWithCheckpoints())
    if (from.CheckpointNumbers(job).empty()) gone.insert(job);
  const Result<std::vector<std::string>> lost =
      KnowsItsLogs(from) ? LostJobs(from)
                         : Status(Code::kNotFound,
                                  "the job table was lost, and with it the logs that tell; "
                                  "`cairn clean --damaged` gives up what it told");
  for (const std::string& job : lost.ok() ? lost.value() : std::vector<std::string>()) {
    const bool is_here = !to.CheckpointNumbers(job).empty();
    copier.KeepWhatItHad(WhyLost(from, job) + (is_here ? "; the copy keeps it as it was" : ""));
    gone.erase(job);
  }
  for (const std::string& job : gone) {
    if (!lost.ok())
      copier.KeepWhatItHad(
          "job " + job +
          ": it has no checkpoint, and whether it was deleted is not known: " + lost.status().message());
    else if (fs::exists(from.Checkpoints() / job, error))  // a deletion takes the folder
      copier.KeepWhatItHad("job " + job + ": none of its checkpoints can be used");
    else if (fs::exists(ResultsIn(from.dir(), job), error))
      copier.KeepWhatItHad("job " + job + ": it has results, but no checkpoint");
    else if (Status status = to.Forget(job, ResultsIn(to.dir(), job)); !status.ok())
      return status;
  }
  return Status::Ok();
}

// What one that ended right after its beginning has left, or nothing. A store that was ever served holds
// more.
bool HoldsNoMoreThanABeginning(const fs::path& to) {
  const std::vector<fs::path> leftovers = Leftovers(to);
  std::error_code error;
  for (fs::recursive_directory_iterator it(to, error), end; !error && it != end; it.increment(error)) {
    const fs::path& path = it->path();
    const bool first = it.depth() == 0 && (path.filename() == "lock" || path.filename() == "version" ||
                                           path.filename() == kRestoreOf);
    const fs::file_type type = it->symlink_status(error).type();
    if (type != fs::file_type::directory && !(first && type == fs::file_type::regular) &&
        std::ranges::find(leftovers, path) == leftovers.end())
      return false;
  }
  return !error;
}

std::string NameOf(const fs::path& store) {
  std::error_code error;
  return fs::weakly_canonical(store, error).string();
}

Status RefuseInside(const fs::path& from, const fs::path& to) {
  std::error_code error;
  const fs::path inside =
      fs::weakly_canonical(to, error).lexically_relative(fs::weakly_canonical(from, error));
  if (inside.empty() || *inside.begin() == "..") return Status::Ok();
  return {Code::kRefused, to.string() + " lies in the store itself"};
}

// A store that was moved is the same one; of one that was copied both go on by themselves.
bool IsACopy(const fs::path& from, const BackupOf& of) {
  const Result<StoreFolder> there = StoreFolder::LookAt(of.store);
  if (!there.ok()) return false;
  const Result<StoreId> id = ReadStoreId(there.value().IdFile());
  std::error_code error;
  return id.ok() && id.value().id == of.id && !fs::equivalent(of.store, from, error);
}

// What is no backup is not even opened.
Status CheckPlace(const fs::path& from, const fs::path& to) {
  if (Status inside = RefuseInside(from, to); !inside.ok()) return inside;
  std::error_code error;
  if (!fs::exists(to, error) || HoldsNoMoreThanABeginning(to)) return Status::Ok();
  if (ReadBackupOf(to / kBackupOf).ok()) return Status::Ok();
  return {Code::kRefused, to.string() + " is there already, and is no backup: name another folder"};
}

// Nothing that is not a copy of this store, or the very one that it was made of, is written over. `to` is
// locked: what it is a backup of is so until this one is done.
Status CheckWhoseItIs(const fs::path& from, const StoreId& id, const StoreFolder& to) {
  const Result<BackupOf> of = ReadBackupOf(to.dir() / kBackupOf);
  if (of.status().code() == Code::kNotFound) return Status::Ok();
  if (!of.ok()) return of.status();
  const std::string is_of = to.dir().string() + " is a backup of ";
  if (of.value().id.empty()) {  // then their places say it
    if (of.value().store == NameOf(from) && !id.was_new) return Status::Ok();
    return {Code::kRefused, is_of + of.value().store + ", not of this store: name another folder"};
  }
  if (!id.restored_from.empty() && id.restored_from == of.value().stamp) return Status::Ok();
  if (id.id != of.value().id)
    return {
        Code::kRefused,
        is_of + "another store than this one, that was at " + of.value().store +
            (id.restored_from.empty() ? "" : "; or of that which this one was restored from, copied since") +
            ": name another folder, or move that one away"};
  if (!IsACopy(from, of.value())) return Status::Ok();
  return {Code::kRefused,
          is_of + of.value().store +
              ", of which this store is a copy (both have the same id): " + "name another folder"};
}

Status CopyTableAndClock(const StoreFolder& from, const StoreFolder& to, BackupFacts& facts) {
  // Of a job that came only now the copy has no checkpoint: it would be taken for lost there.
  const auto keep = [&to](const std::string& job) { return !to.CheckpointNumbers(job).empty(); };
  const Status table = JobTable::Copy(from.JobTable(), to.JobTable(), keep);
  if (!table.ok() && table.code() != Code::kCorrupt && table.code() != Code::kNotFound) return table;
  if (!table.ok()) facts.damaged.push_back("the logs of jobs: " + table.message());
  constexpr std::size_t kMostBytes = 1 << 10;
  const Result<std::string> served = ReadSmallFile(from.ServedFile(), kMostBytes);
  return served.ok() ? WriteTextAtomically(to.ServedFile(), served.value()) : Status::Ok();
}

// All but the marks that say which copy this is.
Result<BackupFacts> CopyStore(const StoreFolder& from, const StoreFolder& to, bool check) {
  Copier copier(from, to, check);
  for (const std::string& job : from.JobsWithCheckpoints())
    if (Status status = copier.CopyJob(job); !status.ok()) return status;
  if (Status status = RemoveWhatIsGone(from, to, copier); !status.ok()) return status;
  // Last: no number that a job ever had is given to another.
  if (Status status = CopyTableAndClock(from, to, copier.facts()); !status.ok()) return status;
  if (copier.all_known()) BlobFiles(to).RemoveAllBut(copier.named());
  return std::move(copier.facts());
}

}  // namespace

Result<BackupFacts> BackUp(const fs::path& from_dir, const fs::path& to_dir, bool check) {
  const Result<StoreFolder> from = StoreFolder::LookAt(from_dir);
  if (!from.ok()) return from.status();
  const Result<StoreId> id = ReadStoreId(from.value().IdFile());
  if (!id.ok()) return id.status();
  if (Status place = CheckPlace(from_dir, to_dir); !place.ok()) return place;
  const Result<StoreFolder> to = StoreFolder::Open(to_dir);
  if (!to.ok()) return to.status();
  if (Status whose = CheckWhoseItIs(from_dir, id.value(), to.value()); !whose.ok()) return whose;
  if (id.value().id.empty() && from.value().JobsWithCheckpoints().empty() &&
      !to.value().JobsWithCheckpoints().empty())
    return Status(Code::kRefused, from_dir.string() + " has no job, but the copy in " + to_dir.string() +
                                      " has: is it the right store?");
  std::error_code error;
  fs::remove(to_dir / kBackupMark, error);
  const BackupOf of{NameOf(from_dir), id.value().id, NewId()};
  if (Status status = WriteBackupOf(to_dir / kBackupOf, of); !status.ok()) return status;
  Result<BackupFacts> facts = CopyStore(from.value(), to.value(), check);
  if (facts.ok() && facts.value().damaged.empty())
    if (Status status =
            WriteTextAtomically(to_dir / kBackupMark, std::to_string(facts.value().jobs) + " jobs\n");
        !status.ok())
      return status;
  return facts;
}

// Its id is another one, for the store that the backup is of may be served yet. Of the two the first that
// copies itself there has it: the other is refused from then on.
Result<BackupFacts> RestoreStore(const fs::path& from, const fs::path& to) {
  const Result<StoreFolder> there = StoreFolder::LookAt(from);
  if (!there.ok()) return there.status();
  const fs::path mark = to / kRestoreOf;
  std::error_code error;
  const Result<BackupOf> begun = ReadBackupOf(mark);
  if (begun.ok() && begun.value().store != NameOf(from))
    return Status(Code::kRefused, to.string() + " holds a part of " + begun.value().store +
                                      ", for `cairn restore` was cut off: `cairn restore " +
                                      begun.value().store + " --store " + to.string() +
                                      "` goes on with it, or remove that folder");
  if (!begun.ok() && fs::exists(to, error) && !HoldsNoMoreThanABeginning(to))
    return Status(Code::kRefused,
                  to.string() + " is there already: move it away, or say --store for another place");
  if (Status inside = RefuseInside(from, to); !inside.ok()) return inside;
  const Result<BackupOf> of = ReadBackupOf(from / kBackupOf);  // a store that is no backup may be copied, too
  const Result<StoreFolder> made = StoreFolder::Open(to);
  if (!made.ok()) return made.status();
  if (Status marked = WriteTextAtomically(mark, NameOf(from) + "\n"); !marked.ok()) return marked;
  Result<BackupFacts> facts = CopyStore(there.value(), made.value(), false);
  if (!facts.ok()) return facts;
  const StoreId id{NewId(), of.ok() ? of.value().stamp : ""};
  if (Status given = WriteStoreId(made.value().IdFile(), id); !given.ok()) return given;
  for (const char* last : {kBackupMark, kBackupOf, kRestoreOf}) fs::remove(to / last, error);
  return facts;
}

}  // namespace cairn::coordinator
