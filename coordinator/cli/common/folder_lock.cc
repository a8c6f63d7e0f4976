#include "coordinator/cli/common/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>

#include "coordinator/cli/common/failure.h"
#include "schema/store/atomic_file.h"

namespace cairn::cli {

FolderLock::FolderLock(const std::filesystem::path& folder, const std::string& busy)
    : fd_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (fd_ < 0) Throw(SystemFailure(folder, "open", errno));
  if (::flock(fd_, busy.empty() ? LOCK_EX : LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  ::close(fd_);
  throw InputError(busy);
}

FolderLock::~FolderLock() { ::close(fd_); }

}  // namespace cairn::cli
