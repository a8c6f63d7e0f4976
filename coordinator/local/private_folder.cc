#include "coordinator/local/private_folder.h"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>

#include "schema/store/atomic_file.h"

namespace cairn::coordinator {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPrefix = "cairn-run-";  // then the process id, then what mkdtemp adds
constexpr std::size_t kLongestBase = 60;       // of the 107 characters that a socket's name may have

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

void RemoveLeftovers(const fs::path& base) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(base, ignored)) {
    if (!entry.path().filename().string().starts_with(kPrefix)) continue;
    const int lock = Lock(entry.path());
    if (lock < 0) continue;
    fs::remove_all(entry.path(), ignored);
    ::close(lock);
  }
}

}  // namespace

Result<PrivateFolder> PrivateFolder::Make() {
  const fs::path base = Base();
  RemoveLeftovers(base);
  constexpr int kTries = 100;  // another run may take a folder that is not locked yet for a leftover
  for (int i = 0; i < kTries; ++i) {
    std::string pattern = (base / (kPrefix + std::to_string(::getpid()) + "-XXXXXX")).string();
    if (::mkdtemp(pattern.data()) == nullptr) return SystemFailure(pattern, "make the folder", errno);
    if (const int lock = Lock(pattern); lock >= 0) return PrivateFolder(pattern, lock);
  }
  return Status(Code::kIo, base.string() + ": no folder made there stays");
}

PrivateFolder::~PrivateFolder() {
  std::error_code ignored;  // the next run removes it
  if (!path_.empty()) fs::remove_all(path_, ignored);
  if (lock_ >= 0) ::close(lock_);
}

}  // namespace cairn::coordinator
