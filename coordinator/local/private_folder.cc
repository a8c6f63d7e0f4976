#include "coordinator/local/private_folder.h"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "schema/store/atomic_file.h"
#include "schema/store/regular_file.h"

namespace cairn::coordinator {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPrefix = "cairn-run-";  // then the process id, then what mkdtemp adds
constexpr const char* kSixLetters = "-XXXXXX";
constexpr const char* kMarker = ".cairn-run";  // a file in it, which says that it is one
constexpr std::size_t kLongestBase = 60;       // of the 107 characters that a socket's name may have

// What its users make in it: the socket and its lock, and the folder of a run that only plans.
constexpr std::array<const char*, 4> kOwn{"hub", "hub.lock", "plan", kMarker};

fs::path Base() {
  std::error_code error;
  fs::path base = fs::temp_directory_path(error);
  if (!error) base = fs::absolute(base, error).lexically_normal();  // a socket's name must be absolute
  return error || base.string().size() > kLongestBase ? fs::path("/tmp") : base;
}

// A descriptor of this user's own folder `path`, locked; -1 where it is none, or another process holds the
// lock. Whoever wants to remove the folder takes the lock too, so under it the folder stays.
int Lock(const fs::path& path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (fd < 0) return -1;
  struct stat opened{}, named{};
  const bool ours = ::fstat(fd, &opened) == 0 && opened.st_uid == ::geteuid();
  if (ours && ::flock(fd, LOCK_EX | LOCK_NB) == 0 && ::lstat(path.c_str(), &named) == 0 &&
      named.st_ino == opened.st_ino)
    return fd;
  ::close(fd);
  return -1;
}

bool HasTheForm(const std::string& name) {
  const std::size_t prefix = std::strlen(kPrefix), letters = std::strlen(kSixLetters);
  if (!name.starts_with(kPrefix) || name.size() <= prefix + letters) return false;
  const std::string pid = name.substr(prefix, name.size() - prefix - letters);
  const std::string random = name.substr(name.size() - letters);
  return pid.find_first_not_of("0123456789") == std::string::npos && random[0] == '-' &&
         std::all_of(random.begin() + 1, random.end(), [](unsigned char c) { return std::isalnum(c) != 0; });
}

// With its name, so that what somebody copies or renames is no longer one.
std::string MarkerOf(const fs::path& path) {
  return "the private folder " + path.filename().string() + " of a cairn process\n";
}

bool IsMarked(const fs::path& path) {
  constexpr std::size_t kMostBytes = 1 << 10;
  struct stat folder{}, marker{};
  const fs::path file = path / kMarker;
  if (::lstat(path.c_str(), &folder) != 0 || !S_ISDIR(folder.st_mode) || folder.st_uid != ::geteuid() ||
      (folder.st_mode & 07777) != 0700 || ::lstat(file.c_str(), &marker) != 0 || !S_ISREG(marker.st_mode))
    return false;
  const Result<std::string> text = ReadSmallFile(file, kMostBytes);
  return text.ok() && text.value() == MarkerOf(path);
}

Status Mark(const fs::path& path) {
  const fs::path file = path / kMarker;
  const std::string text = MarkerOf(path);
  const int fd = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
  if (fd < 0) return SystemFailure(file, "make", errno);
  const ssize_t written = ::write(fd, text.data(), text.size());
  const int error = written < 0 ? errno : written < static_cast<ssize_t>(text.size()) ? ENOSPC : 0;
  ::close(fd);
  return error == 0 ? Status::Ok() : SystemFailure(file, "write", error);
}

bool HoldsNothingElse(const fs::path& path) {
  std::error_code error;
  for (fs::directory_iterator it(path, error), end; !error && it != end; it.increment(error))
    if (std::ranges::find(kOwn, it->path().filename().string()) == kOwn.end()) return false;
  return !error;
}

// Whoever likes may have a folder with such a name: what goes is only what was made here and holds nothing
// that somebody else has put into it.
void RemoveLeftovers(const fs::path& base) {
  std::error_code error;
  for (fs::directory_iterator it(base, error), end; !error && it != end; it.increment(error)) {
    const fs::path& path = it->path();
    if (!HasTheForm(path.filename().string()) || !IsMarked(path)) continue;
    const int lock = Lock(path);
    if (lock < 0) continue;
    if (HoldsNothingElse(path)) {
      std::error_code failed;
      for (const char* own : kOwn)
        if (!failed) fs::remove_all(path / own, failed);  // the marker last
      fs::remove(path, failed);
    }
    ::close(lock);
  }
}

}  // namespace

Result<PrivateFolder> PrivateFolder::Make() {
  const fs::path base = Base();
  RemoveLeftovers(base);
  std::string pattern = (base / (kPrefix + std::to_string(::getpid()) + kSixLetters)).string();
  if (::mkdtemp(pattern.data()) == nullptr) return SystemFailure(pattern, "make the folder", errno);
  const int lock = Lock(pattern);
  if (lock < 0) {
    ::rmdir(pattern.c_str());
    return Status(Code::kIo, pattern + ": the folder cannot be locked");
  }
  PrivateFolder made(pattern, lock);
  if (Status marked = Mark(pattern); !marked.ok()) return marked;
  return made;
}

PrivateFolder::~PrivateFolder() {
  std::error_code ignored;  // the next run removes it
  if (!path_.empty()) fs::remove_all(path_, ignored);
  if (lock_ >= 0) ::close(lock_);
}

}  // namespace cairn::coordinator
