#include "schema/store/atomic_file.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <system_error>

#include "schema/text.h"

namespace cairn {
namespace {

class Descriptor {
 public:
  Descriptor(const std::filesystem::path& path, int flags, mode_t mode = 0)
      : fd_(::open(path.c_str(), flags | O_CLOEXEC, mode)) {}
  ~Descriptor() { Close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }
  int Close() {
    const int result = fd_ < 0 ? 0 : ::close(fd_);
    fd_ = -1;
    return result;
  }

 private:
  int fd_;
};

std::filesystem::path FolderOf(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}

// By which Cairn's temporary files are told from those of other programs, which have such numbers too.
constexpr std::string_view kBegin = ".cairn-", kEnd = ".tmp";

// What the names of temporary files of `path` begin with; the process, a number and kEnd follow.
std::string BeginFor(const std::filesystem::path& path) {
  constexpr std::size_t kMostOfName = 128;  // with the rest it stays a name that a file may have
  return std::string(kBegin) + CutTo(path.filename().string(), kMostOfName) + ".";
}

// The name of a temporary file of `path`, which is this process's as long as the object lives.
class Temporary {
 public:
  explicit Temporary(const std::filesystem::path& path) {
    static std::atomic<unsigned> counter{0};
    const std::string name = BeginFor(path) + std::to_string(::getpid()) + "-";
    path_ = FolderOf(path) / (name + std::to_string(counter++) + std::string(kEnd));
    const std::lock_guard lock(mutex_);
    names_.insert(path_.filename());
  }
  ~Temporary() {
    const std::lock_guard lock(mutex_);
    names_.erase(path_.filename());
  }
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;
  const std::filesystem::path& path() const { return path_; }
  static bool IsInUse(const std::string& name) {
    const std::lock_guard lock(mutex_);
    return names_.contains(name);
  }

 private:
  static inline std::mutex mutex_;
  static inline std::set<std::string> names_;
  std::filesystem::path path_;
};

bool AreDigits(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

// A process with this one's number may have been killed before it: in a container the number is often 1.
bool IsAlive(pid_t owner, const std::string& name) {
  if (owner == ::getpid()) return Temporary::IsInUse(name);
  return ::kill(owner, 0) == 0 || errno != ESRCH;
}

// The process that a temporary file belongs to; 0: the name is none that Temporary makes.
pid_t OwnerOf(std::string_view name) {
  if (!name.starts_with(kBegin) || !name.ends_with(kEnd)) return 0;
  name.remove_prefix(kBegin.size());
  name.remove_suffix(std::min(name.size(), kEnd.size()));
  const std::size_t dash = name.rfind('-'), dot = name.rfind('.', dash);
  if (dash == std::string_view::npos || dot == std::string_view::npos || dot == 0) return 0;
  const std::string_view pid = name.substr(dot + 1, dash - dot - 1);
  if (pid.size() > 9 || !AreDigits(pid) || !AreDigits(name.substr(dash + 1))) return 0;
  return static_cast<pid_t>(std::stol(std::string(pid)));
}

// Returns errno, or 0.
int WriteAll(int fd, std::span<const std::byte> bytes) {
  constexpr std::size_t kAtOnce = std::size_t{1} << 30;  // Linux writes at most 2 GiB a call
  while (!bytes.empty()) {
    const ssize_t count = ::write(fd, bytes.data(), std::min(bytes.size(), kAtOnce));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return errno;
    if (count == 0) return EIO;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return 0;
}

// Returns errno, or 0.
int SetRights(int fd, const FileRights& rights) {
  struct stat has{};
  if (::fstat(fd, &has) != 0) return errno;
  if ((has.st_uid != rights.owner || has.st_gid != rights.group) &&
      ::fchown(fd, rights.owner, rights.group) != 0)
    return errno;
  return ::fchmod(fd, rights.mode) == 0 ? 0 : errno;
}

// Returns errno, or 0.
int WriteSynced(const std::filesystem::path& path, std::span<const std::byte> bytes,
                const FileRights* rights) {
  Descriptor file(path, O_WRONLY | O_CREAT | O_EXCL, rights == nullptr ? 0666 : 0600);
  if (file.get() < 0) return errno;
  if (const int error = rights == nullptr ? 0 : SetRights(file.get(), *rights)) return error;
  if (const int error = WriteAll(file.get(), bytes)) return error;
  if (::fsync(file.get()) != 0 || file.Close() != 0) return errno;
  return 0;
}

// File systems that cannot sync a folder say EINVAL; there is nothing more to be done on them.
int TrySyncFolder(const std::filesystem::path& folder) {
  const Descriptor descriptor(folder, O_RDONLY | O_DIRECTORY);
  if (descriptor.get() < 0) return errno;
  return ::fsync(descriptor.get()) != 0 && errno != EINVAL ? errno : 0;
}

// The place is not one to write to, whoever's program asks: another has to be named.
bool IsRefusal(int error_number) {
  switch (error_number) {
    case EACCES:
    case EPERM:
    case EROFS:
    case EISDIR:
    case EEXIST:
    case ELOOP:
    case ENAMETOOLONG:
      return true;
    default:
      return false;
  }
}

// Its bytes are not what it lacks. File systems that make room for files as they need it say that they have
// 0.
// Returns errno, or 0.
int RenameOver(const std::filesystem::path& from, const std::filesystem::path& to) {
  return ::rename(from.c_str(), to.c_str()) == 0 ? 0 : errno;
}

// EEXIST where `to` is there. File systems that do not know how say EINVAL.
int RenameToNew(const std::filesystem::path& from, const std::filesystem::path& to) {
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return 0;
  const int error = errno;
  if (error != EINVAL && error != ENOSYS) return error;
  std::error_code ignored;
  const bool is_there = std::filesystem::exists(std::filesystem::symlink_status(to, ignored));
  return is_there ? EEXIST : RenameOver(from, to);
}

// `write` makes the temporary file; EEXIST where there is one.
Status WriteAndPublish(const std::filesystem::path& path,
                       const std::function<int(const std::filesystem::path& temporary)>& write,
                       int (*publish)(const std::filesystem::path& from, const std::filesystem::path& to)) {
  if (IsNoFile(path))
    return {Code::kRefused, path.string() + ": is a device, a pipe or a socket; a file is needed"};
  std::optional<Temporary> temporary;
  int error = EEXIST;
  while (error == EEXIST) {  // left by a process that had this one's number
    temporary.emplace(path);
    error = write(temporary->path());
  }
  if (error == 0) error = publish(temporary->path(), path);
  if (error != 0) {
    ::unlink(temporary->path().c_str());
    return SystemFailure(path, "cannot write", error);
  }
  if (const int sync = TrySyncFolder(FolderOf(path)))
    return SystemFailure(path, "cannot sync its folder", sync);
  return Status::Ok();
}

Status WriteAndPublish(const std::filesystem::path& path, std::span<const std::byte> bytes,
                       const FileRights* rights,
                       int (*publish)(const std::filesystem::path& from, const std::filesystem::path& to)) {
  return WriteAndPublish(
      path, [&](const std::filesystem::path& to) { return WriteSynced(to, bytes, rights); }, publish);
}

}  // namespace

bool HasNoRoomForFiles(const std::filesystem::path& folder) {
  struct statvfs disk{};
  return ::statvfs(folder.c_str(), &disk) == 0 && disk.f_files > 0 && disk.f_favail == 0 && disk.f_bavail > 0;
}

Status SystemFailure(const std::filesystem::path& path, const std::string& doing, int error_number) {
  const bool full = error_number == ENOSPC || error_number == EDQUOT || error_number == EFBIG;
  const bool missing = error_number == ENOENT || error_number == ENOTDIR;
  const std::string cause = error_number == EFBIG ? "no file may grow so large here (ulimit -f)"
                            : error_number == ENOSPC && HasNoRoomForFiles(FolderOf(path))
                                ? "no space left: the disk that holds it has no room for more files (inodes)"
                            : error_number == ENOSPC  ? "no space left: the disk that holds it is full"
                            : full                    ? "no space left: over a quota"
                            : error_number == ENOTDIR ? "there is a file where a folder is needed"
                            : missing                 ? "no such file or folder"
                                                      : std::generic_category().message(error_number);
  return {full                      ? Code::kNoSpace
          : missing                 ? Code::kNotFound
          : IsRefusal(error_number) ? Code::kRefused
                                    : Code::kIo,
          path.string() + ": " + doing + ": " + cause};
}

bool IsNoFile(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  return std::filesystem::exists(status) && !std::filesystem::is_regular_file(status) &&
         !std::filesystem::is_directory(status);
}

Status WriteFileAtomically(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  return WriteAndPublish(path, bytes, nullptr, RenameOver);
}

Status WriteNewFileAtomically(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  return WriteAndPublish(path, bytes, nullptr, RenameToNew);
}

Status WriteInPlaceAtomically(const std::filesystem::path& path, bool is_new,
                              const std::function<Status(const std::filesystem::path& temporary)>& fill) {
  Status filled;
  const auto write = [&](const std::filesystem::path& temporary) {
    Descriptor file(temporary, O_RDONLY | O_CREAT | O_EXCL, 0666);
    if (file.get() < 0) return errno;
    filled = fill(temporary);
    return filled.ok() && ::fsync(file.get()) == 0 ? 0 : filled.ok() ? errno : EIO;
  };
  const Status published = WriteAndPublish(path, write, is_new ? RenameToNew : RenameOver);
  return filled.ok() ? published : filled;
}

Status WriteTextAtomically(const std::filesystem::path& path, std::string_view text) {
  return WriteAndPublish(path, std::as_bytes(std::span(text)), nullptr, RenameOver);
}

Status WriteTextAtomically(const std::filesystem::path& path, std::string_view text,
                           const FileRights& rights) {
  return WriteAndPublish(path, std::as_bytes(std::span(text)), &rights, RenameOver);
}

Status SyncFolder(const std::filesystem::path& folder) {
  const int error = TrySyncFolder(folder);
  return error == 0 ? Status::Ok() : SystemFailure(folder, "cannot sync", error);
}

std::vector<std::filesystem::path> Leftovers(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> leftovers;
  std::error_code error;
  std::filesystem::directory_iterator it(folder, error);
  for (const std::filesystem::directory_iterator end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    const pid_t owner = OwnerOf(name);
    std::error_code ignored;
    if (owner > 0 && !IsAlive(owner, name) && std::filesystem::is_regular_file(it->symlink_status(ignored)))
      leftovers.push_back(it->path());
  }
  return leftovers;
}

void RemoveLeftovers(const std::filesystem::path& folder) {
  std::error_code ignored;
  for (const std::filesystem::path& path : Leftovers(folder)) std::filesystem::remove(path, ignored);
}

void RemoveLeftoversOf(const std::filesystem::path& file) {
  const std::string begin = BeginFor(file);
  for (const std::filesystem::path& path : Leftovers(FolderOf(file))) {
    const std::string name = path.filename().string();
    std::error_code ignored;
    // Of "a", not of "a.b", whose name begins with it.
    if (name.starts_with(begin) && name.find('.', begin.size()) == name.size() - kEnd.size())
      std::filesystem::remove(path, ignored);
  }
}

}  // namespace cairn
