#include "schema/store/atomic_file.h"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <string>
#include <string_view>
#include <system_error>

namespace cairn {
namespace {

class Descriptor {
 public:
  Descriptor(const std::filesystem::path& path, int flags)
      : fd_(::open(path.c_str(), flags | O_CLOEXEC, 0666)) {}
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

std::filesystem::path TemporaryFor(const std::filesystem::path& path) {
  static std::atomic<unsigned> counter{0};
  return FolderOf(path) / ("." + path.filename().string() + "." + std::to_string(::getpid()) + "-" +
                           std::to_string(counter++) + ".tmp");
}

bool AreDigits(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

// The process that a temporary file belongs to; 0: the name is none that TemporaryFor makes.
pid_t OwnerOf(std::string_view name) {
  constexpr std::string_view kEnd = ".tmp";
  if (!name.starts_with('.') || !name.ends_with(kEnd)) return 0;
  name.remove_suffix(kEnd.size());
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
int WriteSynced(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  Descriptor file(path, O_WRONLY | O_CREAT | O_EXCL);
  if (file.get() < 0) return errno;
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

}  // namespace

Status SystemFailure(const std::filesystem::path& path, const std::string& doing, int error_number) {
  const bool full = error_number == ENOSPC || error_number == EDQUOT || error_number == EFBIG;
  const bool missing = error_number == ENOENT || error_number == ENOTDIR;
  const std::string cause = error_number == EFBIG     ? "no file may grow so large here (ulimit -f)"
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
  if (IsNoFile(path))
    return {Code::kRefused, path.string() + ": is a device, a pipe or a socket; a file is needed"};
  const std::filesystem::path temporary = TemporaryFor(path);
  int error = WriteSynced(temporary, bytes);
  if (error == 0 && ::rename(temporary.c_str(), path.c_str()) != 0) error = errno;
  if (error != 0) {
    // Another process's file of that name stays (EEXIST): only what was made here is removed.
    if (error != EEXIST) ::unlink(temporary.c_str());
    return SystemFailure(path, "cannot write", error);
  }
  if (const int sync = TrySyncFolder(FolderOf(path)))
    return SystemFailure(path, "cannot sync its folder", sync);
  return Status::Ok();
}

Status WriteTextAtomically(const std::filesystem::path& path, std::string_view text) {
  return WriteFileAtomically(path, std::as_bytes(std::span(text)));
}

Status SyncFolder(const std::filesystem::path& folder) {
  const int error = TrySyncFolder(folder);
  return error == 0 ? Status::Ok() : SystemFailure(folder, "cannot sync", error);
}

std::vector<std::filesystem::path> Leftovers(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> leftovers;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const pid_t owner = OwnerOf(entry.path().filename().string());
    if (owner > 0 && ::kill(owner, 0) != 0 && errno == ESRCH) leftovers.push_back(entry.path());
  }
  return leftovers;
}

void RemoveLeftovers(const std::filesystem::path& folder) {
  std::error_code ignored;
  for (const std::filesystem::path& path : Leftovers(folder)) std::filesystem::remove(path, ignored);
}

}  // namespace cairn
