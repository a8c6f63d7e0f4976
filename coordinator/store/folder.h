// The folder in which a coordinator keeps everything; one coordinator at a time has it.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/store/holder.h"
#include "schema/error.h"
#include "schema/hash.h"

namespace cairn::coordinator {

// What DIR/version says. Version 1 had no such file; its files may have no checksum trailers. 2 had no flat
// blobs.
inline constexpr int kStoreVersion = 3;

// In a store that is being made of a backup: of which (RestoreStore).
inline constexpr const char* kRestoreOf = "restore-of";
// In each backup: of which store it is (store_id.h).
inline constexpr const char* kBackupOf = "backup-of";

// Thrown where a file of a store may be whole and yet cannot be read (the disk fails, a right is missing):
// what it names is not known, so that nothing may be quarantined or removed for its sake.
struct UnreadableStore : std::runtime_error {
  explicit UnreadableStore(const Status& status)
      : std::runtime_error(
            status.message() +
            ": the store is left as it is; start again, or, where the disk is bad, move that file "
            "away") {}
};

// Whether `status` of a file says no more than that it could not be looked at.
inline bool SaysNothing(const Status& status) {
  return !status.ok() && status.code() != Code::kCorrupt && status.code() != Code::kNotFound &&
         status.code() != Code::kVersion;
}

class StoreFolder {
 public:
  // Makes it where it does not exist, with mode 0700, and locks it until the object goes.
  // kCorrupt: a folder that holds something, but no store.
  // kBusy: another process has it, or has a store whose blobs are the same folder.
  // kRefused: there is a link in it (but among a service's results); nothing is followed out of a store.
  // kCorrupt, too: it has checkpoints, and a folder that they need is gone (a disk that is not mounted).
  // kVersion: it is of a newer version, or from before files had checksum trailers; then nothing in it is
  // touched.
  static Result<StoreFolder> Open(const std::filesystem::path& dir);
  // The same for a coordinator, which calls Serve once it has all else that it needs.
  // kRefused, too: it is a backup, whose next one would remove what is done there; or not all that a restore
  // brings is there.
  static Result<StoreFolder> OpenToServe(const std::filesystem::path& dir);
  // From now on other machines that see the folder find out that it is served (holder.h), and whoever served
  // it writes nothing more. One that has no id yet gets one (store_id.h).
  // kBusy: another machine's has it, as far as anybody knows, and it is not to be taken over.
  Status Serve(bool take_over);
  // The same of a store that is there, in which nothing is touched but the lock.
  static Result<StoreFolder> OpenAsItIs(const std::filesystem::path& dir);
  // The same without the lock: another process may have it, and change what is looked at.
  // kNotFound: there is no store.
  static Result<StoreFolder> LookAt(const std::filesystem::path& dir);
  StoreFolder(StoreFolder&& other) noexcept;
  StoreFolder& operator=(StoreFolder&&) = delete;
  ~StoreFolder();

  const std::filesystem::path& dir() const { return dir_; }
  std::filesystem::path JobTable() const { return dir_ / "jobs.sqlite"; }
  std::filesystem::path VersionFile() const { return dir_ / "version"; }
  std::filesystem::path HolderFile() const { return dir_ / "holder"; }
  std::filesystem::path IdFile() const { return dir_ / "id"; }          // store_id.h
  std::filesystem::path ServedFile() const { return dir_ / "served"; }  // served_file.h
  std::filesystem::path Blobs() const { return dir_ / "blobs"; }
  std::filesystem::path BlobFile(const Hash& hash) const { return Blobs() / (hash.Hex() + ".h5"); }
  std::filesystem::path FlatFile(const Hash& hash) const { return Blobs() / (hash.Hex() + ".flat"); }
  std::filesystem::path Uploads() const { return dir_ / "uploads"; }  // that are under way
  std::filesystem::path PackFile(const Hash& hash) const { return Blobs() / ("pack-" + hash.Hex() + ".h5"); }
  std::vector<std::filesystem::path> PackFiles() const;  // sorted
  std::vector<Hash> BlobsAlone() const;                  // that have files of their own; sorted
  std::filesystem::path Checkpoints() const { return dir_ / "checkpoints"; }
  std::filesystem::path CheckpointFile(const std::string& job, std::uint64_t number) const {
    return Checkpoints() / job / (std::to_string(number) + ".h5");
  }
  // Numbers of a job's checkpoint files, ascending.
  std::vector<std::uint64_t> CheckpointNumbers(const std::string& job) const;
  std::vector<std::string> JobsWithCheckpoints() const;  // sorted
  // Removes a job's checkpoints and its folder of results; behind a link only what it published (forget.h).
  // Ok: it is durable that the job is gone; what is left of it FinishForgetting removes at the next start.
  // Else all is as it was.
  Status Forget(const std::string& job, const std::filesystem::path& results) const;
  // `results_of`: the folder of a job's results.
  void FinishForgetting(const std::function<std::filesystem::path(const std::string& job)>& results_of) const;
  // Forgets all jobs. What is none of a store's stays.
  Status Clear();
  // Whether what is called dir() is still the folder that was opened, and its own folders no links. Not Ok:
  // it was removed, moved, or replaced by a link, or another machine has taken it over; nothing may be
  // written there any more, for nobody would find it, or it would be written where somebody else wants it.
  Status IsStillThere() const;
  // What IsStillThere said of another machine, from whatever thread; empty: nothing.
  std::string TakenOver() const;
  // Nobody serves it any more: another machine may at once.
  void GiveBack();
  // The same, and that a job's checkpoints lie in no link.
  Status MayWriteCheckpoints(const std::string& job) const;

 private:
  StoreFolder(std::filesystem::path dir, int lock);
  static constexpr int kNoLock = -1;
  static bool IsForeign(const std::filesystem::path& dir);
  Status CheckVersion() const;
  Status MakeFolders() const;
  static Result<StoreFolder> Make(const std::filesystem::path& dir);
  Status Prepare();
  Status Claim(bool take_over);
  Status GiveId() const;
  Status IsStillOurs() const;
  // Against another store whose `blobs` is the same folder, by a mount: each would remove what the other
  // needs.
  Status LockBlobs();

  std::filesystem::path dir_;
  enum class Lost { kNot, kToAnother, kUnknown };  // kUnknown: nothing says who serves it now

  int lock_ = kNoLock;            // file descriptor
  int blobs_lock_ = kNoLock;      // of `blobs`
  std::optional<Holder> holder_;  // this process, where it serves
  mutable std::atomic<Lost> lost_{Lost::kNot};
  std::pair<std::uint64_t, std::uint64_t> id_;  // of what is called dir(), be it a link: device and inode
};

// What lies right in a folder; where that cannot be read to its end, what was found until then.
std::vector<std::filesystem::path> EntriesOf(const std::filesystem::path& folder);

// Renames a damaged file so that it is never read again but can be looked at: FILE.damaged.
void Quarantine(const std::filesystem::path& file);

// What a store takes on disk, against its limit. Counted by the thread that writes; any thread may look.
class StoreUse {
 public:
  // 0: no limit.
  StoreUse(std::filesystem::path dir, std::uint64_t limit_bytes);

  // Of all files, as of the last Count and what was reserved since; what was removed since is still in it.
  std::uint64_t bytes() const { return bytes_; }
  std::uint64_t limit_bytes() const { return limit_bytes_; }
  // Looks at every file.
  void Count();
  // `more` bytes are about to be written. kNoSpace: they would go over the limit.
  Status Reserve(std::uint64_t more_bytes);
  // Why so much more would not fit, for people; empty where it does.
  std::string WhyNoRoom(std::uint64_t more_bytes) const;

 private:
  const std::filesystem::path dir_;
  const std::uint64_t limit_bytes_;
  std::atomic<std::uint64_t> bytes_{0};
};

}  // namespace cairn::coordinator
