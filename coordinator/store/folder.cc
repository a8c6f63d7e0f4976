#include "coordinator/store/folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <utility>

#include "coordinator/store/forget.h"
#include "coordinator/store/store_id.h"
#include "schema/store/atomic_file.h"
#include "schema/store/checksum_trailer.h"
#include "schema/store/regular_file.h"
#include "schema/text.h"

namespace cairn::coordinator {

namespace fs = std::filesystem;

namespace {
constexpr const char* kGone = ".deleted";  // a job's folder of checkpoints, once the job is deleted

Status ALink(const fs::path& path) {
  return {Code::kRefused, path.string() + " is a link; a store keeps what it needs in its own folder"};
}

// Of what has this name, not of what a link leads to.
std::pair<std::uint64_t, std::uint64_t> IdOf(const fs::path& path) {
  struct stat named{};
  if (::lstat(path.c_str(), &named) != 0) return {};
  return {named.st_dev, named.st_ino};
}

bool IsALink(const fs::path& path) {
  std::error_code error;
  return fs::is_symlink(fs::symlink_status(path, error));
}

bool IsAFolder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

// Whoever hands on a store must not choose which of the next person's files are written or removed. Where the
// results of a service lie is its own user's choice.
Status RefuseLinks(const fs::path& dir) {
  std::error_code error;
  for (fs::recursive_directory_iterator it(dir, error), end; !error && it != end; it.increment(error)) {
    if (it.depth() == 0 && it->path().filename() == "results")
      it.disable_recursion_pending();
    else if (it->is_symlink(error))
      return ALink(it->path());
  }
  return error ? SystemFailure(dir, "look through", error.value()) : Status::Ok();
}
// 0: the folder has none yet; -1: what is there is no version.
Result<int> ReadVersion(const fs::path& path) {
  constexpr std::size_t kMostBytes = 1 << 10;
  const Result<std::string> text = ReadSmallFile(path, kMostBytes);
  if (!text.ok()) return text.status().code() == Code::kNotFound ? Result<int>(0) : text.status();
  int version = 0;
  const std::string digits = text.value().substr(0, text.value().find_first_not_of("0123456789"));
  const auto [rest, failed] = std::from_chars(digits.data(), digits.data() + digits.size(), version);
  return failed == std::errc{} && version > 1 ? version : -1;
}

}  // namespace

Result<StoreFolder> StoreFolder::Make(const fs::path& dir) {
  std::error_code error;
  const bool made = fs::create_directories(dir, error);
  if (error) return SystemFailure(dir, "make the folder", error.value());
  if (made) fs::permissions(dir, fs::perms::owner_all, error);
  return OpenAsItIs(dir);
}

Result<StoreFolder> StoreFolder::Open(const fs::path& dir) {
  Result<StoreFolder> folder = Make(dir);
  if (!folder.ok()) return folder;
  if (Status status = folder.value().Prepare(); !status.ok()) return status;
  return folder;
}

Result<StoreFolder> StoreFolder::OpenToServe(const fs::path& dir) {
  Result<StoreFolder> folder = Make(dir);
  if (!folder.ok()) return folder;
  constexpr std::size_t kMostBytes = 1 << 13;
  if (const Result<std::string> of = ReadSmallFile(dir / kRestoreOf, kMostBytes); of.ok())
    return Status(
        Code::kRefused,
        dir.string() + " holds a part of a backup, for `cairn restore` was cut off: `cairn restore " +
            of.value().substr(0, of.value().find('\n')) + " --store " + dir.string() + "` goes on with it");
  if (std::error_code error; fs::exists(fs::symlink_status(dir / kBackupOf, error)))
    return Status(Code::kRefused, dir.string() + " is a backup, and stays one: `cairn restore " +
                                      dir.string() +
                                      " --store ANOTHER` makes a store of it that can be served");
  return folder;
}

Status StoreFolder::Serve(bool take_over) {
  if (Status status = MakeFolders(); !status.ok()) return status;
  if (Status status = Claim(take_over); !status.ok()) return status;
  Status status = GiveId();
  if (status.ok()) status = Prepare();
  if (!status.ok()) GiveBack();
  return status;
}

Status StoreFolder::Prepare() {
  if (Status status = MakeFolders(); !status.ok()) return status;
  if (Status status = LockBlobs(); !status.ok()) return status;
  std::error_code error;
  for (fs::recursive_directory_iterator it(dir_, error), end; !error && it != end; it.increment(error))
    if (IsAFolder(it->path())) RemoveLeftovers(it->path());
  // Of whom they came, nobody is there any more.
  for (const fs::path& path : EntriesOf(Uploads())) {
    std::error_code ignored;
    if (path.extension() == ".part") fs::remove(path, ignored);
  }
  return Status::Ok();
}

// One that is damaged was written by nobody who could be asked.
Status StoreFolder::Claim(bool take_over) {
  Result<Holder> last = ReadHolder(HolderFile());
  if (!last.ok() && last.status().code() != Code::kCorrupt) return last.status();
  const Holder next = NextHolder(last.ok() ? last.value() : Holder{});
  const std::string why = last.ok() ? WhyNotHold(last.value(), next) : last.status().message();
  if (!why.empty() && !take_over) return {Code::kBusy, dir_.string() + ": " + why};
  if (Status status = WriteHolder(HolderFile(), next); !status.ok()) return status;
  holder_ = next;
  return Status::Ok();
}

Status StoreFolder::GiveId() const {
  const Result<StoreId> id = ReadStoreId(IdFile());
  if (!id.ok()) return id.status();
  if (!id.value().id.empty()) return Status::Ok();
  std::error_code error;
  const bool is_new = JobsWithCheckpoints().empty() && !fs::exists(JobTable(), error);
  return WriteStoreId(IdFile(), {.id = NewId(), .restored_from = {}, .was_new = is_new});
}

// A number that is the next one's is not told by its value alone: of a damaged file two might begin with the
// same.
Status StoreFolder::IsStillOurs() const {
  if (!holder_) return Status::Ok();
  const Result<Holder> holder = ReadHolder(HolderFile());
  if (holder.ok() && holder.value() == *holder_) return Status::Ok();
  if (SaysNothing(holder.status())) return holder.status();
  lost_ = holder.ok() && holder.value().number > 0 ? Lost::kToAnother : Lost::kUnknown;
  return {Code::kIo, TakenOver()};
}

std::string StoreFolder::TakenOver() const {
  switch (lost_.load()) {
    case Lost::kNot:
      return "";
    case Lost::kToAnother:
      return "another coordinator has taken the store over; nothing is written there any more";
    case Lost::kUnknown:
      return "its file 'holder' was removed or damaged, so that another coordinator may have taken the store "
             "over; nothing is written there any more: where no other machine serves it, start with "
             "--take-over";
  }
  return "";
}

void StoreFolder::GiveBack() {
  if (!holder_ || !IsStillThere().ok()) return;
  holder_->serves = false;
  static_cast<void>(WriteHolder(HolderFile(), *holder_));  // else the next one is asked whether it takes over
  holder_.reset();
}

Result<StoreFolder> StoreFolder::OpenAsItIs(const fs::path& dir) {
  const Status foreign(Code::kCorrupt, dir.string() + " holds files of something else, and no store");
  const fs::path lock_file = dir / "lock";
  // What looks foreign and is locked may be a store that another process is making. Where it is foreign no
  // lock is left.
  const int create = IsForeign(dir) ? 0 : O_CREAT;
  const int lock = ::open(lock_file.c_str(), O_RDWR | create | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (lock < 0 && errno == ENOENT && create == 0) return foreign;
  if (lock < 0 && errno == ELOOP) return ALink(lock_file);
  if (lock < 0) return SystemFailure(lock_file, "open", errno);
  StoreFolder folder(dir, lock);
  if (::flock(lock, LOCK_EX | LOCK_NB) != 0)
    return Status(Code::kBusy, dir.string() + " is in use by another cairn process");
  if (IsForeign(dir)) return foreign;
  if (Status status = RefuseLinks(dir); !status.ok()) return status;
  if (Status status = folder.CheckVersion(); !status.ok()) return status;
  if (Status status = folder.LockBlobs(); !status.ok()) return status;
  return folder;
}

Result<StoreFolder> StoreFolder::LookAt(const fs::path& dir) {
  StoreFolder folder(dir, kNoLock);
  std::error_code error;
  if (!fs::exists(folder.VersionFile(), error)) return Status(Code::kNotFound, dir.string() + " is no store");
  if (Status status = RefuseLinks(dir); !status.ok()) return status;
  if (Status status = folder.CheckVersion(); !status.ok()) return status;
  return folder;
}

Status StoreFolder::LockBlobs() {
  if (blobs_lock_ >= 0) return Status::Ok();
  blobs_lock_ = ::open(Blobs().c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  // Where a file system has no such locks (NFS), the store's own has to do.
  if (blobs_lock_ < 0 || ::flock(blobs_lock_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK)
    return Status::Ok();
  return {Code::kBusy, Blobs().string() + " is in use by another store of another cairn process"};
}

StoreFolder::StoreFolder(fs::path dir, int lock) : dir_(std::move(dir)), lock_(lock), id_(IdOf(dir_)) {}

StoreFolder::StoreFolder(StoreFolder&& other) noexcept
    : dir_(std::move(other.dir_)),
      lock_(std::exchange(other.lock_, kNoLock)),
      blobs_lock_(std::exchange(other.blobs_lock_, kNoLock)),
      holder_(std::move(other.holder_)),
      lost_(other.lost_.load()),
      id_(other.id_) {}

StoreFolder::~StoreFolder() {
  for (const int lock : {lock_, blobs_lock_})
    if (lock >= 0) ::close(lock);  // and with it the lock
}

// Each store has a version but those of version 1, which have a table of jobs. New ones hold nothing.
bool StoreFolder::IsForeign(const fs::path& dir) {
  const StoreFolder folder(dir, kNoLock);
  std::error_code error;
  if (fs::exists(folder.VersionFile(), error) || fs::exists(folder.JobTable(), error)) return false;
  const std::vector<fs::path> leftovers = Leftovers(dir);
  return std::ranges::any_of(EntriesOf(dir), [&](const fs::path& path) {
    return path.filename() != "lock" && std::ranges::find(leftovers, path) == leftovers.end();
  });
}

Status StoreFolder::IsStillThere() const {
  struct stat held{}, named{};
  const fs::path lock_file = dir_ / "lock";
  if (::fstat(lock_, &held) != 0 || ::stat(lock_file.c_str(), &named) != 0 || held.st_dev != named.st_dev ||
      held.st_ino != named.st_ino)
    return {Code::kIo, "the store was moved or removed while it was in use"};
  const fs::path* linked = IdOf(dir_) != id_ ? &dir_ : nullptr;
  const std::array own{Blobs(), Checkpoints(), Uploads()};
  for (const fs::path& folder : own)
    if (IsALink(folder)) linked = &folder;
  if (linked == nullptr) return IsStillOurs();
  return {Code::kIo,
          linked->string() + " was replaced by a link while it was in use; nothing is written there"};
}

Status StoreFolder::MayWriteCheckpoints(const std::string& job) const {
  if (Status there = IsStillThere(); !there.ok()) return there;
  return IsALink(Checkpoints() / job) ? ALink(Checkpoints() / job) : Status::Ok();
}

Status StoreFolder::CheckVersion() const {
  const Result<int> read = ReadVersion(VersionFile());
  if (!read.ok()) return read.status();
  const int version = read.value();
  if (version < 0) return {Code::kCorrupt, VersionFile().string() + ": not the version of a store"};
  if (version > kStoreVersion)
    return {Code::kVersion, dir_.string() + ": a store of version " + std::to_string(version) +
                                ", of a newer Cairn; this one knows version " +
                                std::to_string(kStoreVersion)};
  if (version > 0) return Status::Ok();
  // Of version 1, or new. One checksum trailer tells that all files were written with checksum trailers: the
  // others are damaged.
  bool any = false;
  for (const std::string& job : JobsWithCheckpoints())
    for (const std::uint64_t number : CheckpointNumbers(job)) {
      if (store::HasTrailer(CheckpointFile(job, number))) return Status::Ok();
      any = true;
    }
  if (!any) return Status::Ok();
  return {Code::kVersion, dir_.string() +
                              ": its files have no checksum trailers: they were written by an older Cairn, " +
                              "which can finish these jobs; this one needs another folder"};
}

Status StoreFolder::MakeFolders() const {
  const Result<int> version = ReadVersion(VersionFile());
  if (!version.ok()) return version.status();
  if (version.value() != kStoreVersion)
    if (Status status = WriteTextAtomically(VersionFile(), std::to_string(kStoreVersion) + "\n");
        !status.ok())
      return status;
  std::error_code none;
  if (version.value() == kStoreVersion && !fs::exists(Blobs(), none) && !JobsWithCheckpoints().empty())
    return {Code::kCorrupt,
            Blobs().string() + " is gone, and jobs need it: is its disk not mounted? Nothing was touched"};
  for (const fs::path& folder : {Blobs(), Checkpoints(), Uploads()}) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) return SystemFailure(folder, "make the folder", error.value());
  }
  return Status::Ok();
}

std::vector<std::uint64_t> StoreFolder::CheckpointNumbers(const std::string& job) const {
  std::vector<std::uint64_t> numbers;
  for (const fs::path& path : EntriesOf(Checkpoints() / job)) {
    const std::string stem = path.stem().string();
    std::uint64_t number = 0;
    const auto end = std::from_chars(stem.data(), stem.data() + stem.size(), number);
    if (path.extension() == ".h5" && end.ec == std::errc() && end.ptr == stem.data() + stem.size())
      numbers.push_back(number);
  }
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

std::vector<std::string> StoreFolder::JobsWithCheckpoints() const {
  std::vector<std::string> jobs;
  for (const fs::path& path : EntriesOf(Checkpoints()))
    if (path.extension() != kGone && IsAFolder(path)) jobs.push_back(path.filename().string());
  std::sort(jobs.begin(), jobs.end());
  return jobs;
}

std::vector<fs::path> StoreFolder::PackFiles() const {
  std::vector<fs::path> packs;
  for (const fs::path& path : EntriesOf(Blobs()))
    if (path.filename().string().starts_with("pack-") && path.extension() == ".h5") packs.push_back(path);
  std::sort(packs.begin(), packs.end());
  return packs;
}

std::vector<Hash> StoreFolder::BlobsAlone() const {
  std::vector<Hash> blobs;
  for (const fs::path& path : EntriesOf(Blobs())) {
    const Result<Hash> hash = Hash::FromHex(path.stem().string());
    const bool is_blob = path.extension() == ".h5" || path.extension() == ".flat";
    if (hash.ok() && is_blob) blobs.push_back(hash.value());
  }
  std::sort(blobs.begin(), blobs.end());
  blobs.erase(std::unique(blobs.begin(), blobs.end()), blobs.end());
  return blobs;
}

// The rename says that the job is gone; the rest is tidying up, which the next start does where this one
// cannot.
Status StoreFolder::Forget(const std::string& job, const fs::path& results) const {
  const fs::path checkpoints = Checkpoints() / job, gone = Checkpoints() / (job + kGone);
  std::error_code error;
  if (fs::exists(checkpoints, error)) {
    fs::rename(checkpoints, gone, error);
    if (error) return SystemFailure(checkpoints, "rename", error.value());
    if (Status status = SyncFolder(Checkpoints()); !status.ok()) {
      fs::rename(gone, checkpoints, error);
      return status;
    }
  }
  if (IsALink(results.parent_path()))
    RemovePublished(results, job, gone);
  else if (!results.empty())
    fs::remove_all(results, error);
  if (!error) fs::remove_all(gone, error);
  return Status::Ok();
}

void StoreFolder::FinishForgetting(const std::function<fs::path(const std::string& job)>& results_of) const {
  std::vector<std::string> jobs;
  for (const fs::path& path : EntriesOf(Checkpoints()))
    if (path.extension() == kGone) jobs.push_back(path.stem().string());
  // The next start tries again.
  for (const std::string& job : jobs) static_cast<void>(Forget(job, results_of(job)));
}

Status StoreFolder::Clear() {
  if (blobs_lock_ >= 0) ::close(std::exchange(blobs_lock_, kNoLock));
  std::vector<fs::path> own = {Blobs(), Checkpoints(), Uploads(), ServedFile()};
  for (const char* ending : {"", "-wal", "-shm", "-journal", ".damaged"})
    own.push_back(JobTable().string() + ending);
  for (const fs::path& path : own) {
    std::error_code error;
    fs::remove_all(path, error);
    if (error) return SystemFailure(path, "remove", error.value());
  }
  if (Status status = MakeFolders(); !status.ok()) return status;
  return LockBlobs();
}

std::vector<fs::path> EntriesOf(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    entries.push_back(it->path());
  return entries;
}

void Quarantine(const fs::path& file) {
  std::error_code ignored;  // where even this fails, the file stays and is found damaged again
  fs::rename(file, file.string() + ".damaged", ignored);
}

StoreUse::StoreUse(fs::path dir, std::uint64_t limit_bytes)
    : dir_(std::move(dir)), limit_bytes_(limit_bytes) {
  Count();
}

void StoreUse::Count() {
  std::uint64_t bytes = 0;
  std::error_code error;
  for (fs::recursive_directory_iterator it(dir_, error), end; !error && it != end; it.increment(error)) {
    std::error_code gone;  // what vanishes meanwhile takes no room
    const std::uint64_t size = it->is_regular_file(gone) ? it->file_size(gone) : 0;
    if (!gone) bytes += size;
  }
  bytes_ = bytes;
}

std::string StoreUse::WhyNoRoom(std::uint64_t more_bytes) const {
  const std::uint64_t used = bytes_;
  if (limit_bytes_ == 0 || (used <= limit_bytes_ && more_bytes <= limit_bytes_ - used)) return "";
  return "the store holds " + BytesText(used) + " of at most " + BytesText(limit_bytes_) + " (--store-gb); " +
         BytesText(more_bytes) + " more do not fit";
}

Status StoreUse::Reserve(std::uint64_t more_bytes) {
  if (!WhyNoRoom(more_bytes).empty()) Count();  // much may have been removed
  if (const std::string why = WhyNoRoom(more_bytes); !why.empty()) return {Code::kNoSpace, why};
  bytes_ += more_bytes;
  return Status::Ok();
}

}  // namespace cairn::coordinator
