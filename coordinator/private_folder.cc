#include "coordinator/private_folder.h"

#include <signal.h>
#include <stdlib.h>
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
  const fs::path base = fs::temp_directory_path(error);
  return error || base.string().size() > kLongestBase ? fs::path("/tmp") : base;
}

void RemoveLeftovers(const fs::path& base) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(base, ignored)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(kPrefix)) continue;
    const pid_t pid =
        static_cast<pid_t>(std::strtol(name.c_str() + std::char_traits<char>::length(kPrefix), nullptr, 10));
    struct stat info{};
    const bool ours =
        ::lstat(entry.path().c_str(), &info) == 0 && info.st_uid == ::geteuid() && S_ISDIR(info.st_mode);
    if (ours && pid > 0 && ::kill(pid, 0) != 0 && errno == ESRCH) fs::remove_all(entry.path(), ignored);
  }
}

}  // namespace

Result<PrivateFolder> PrivateFolder::Make() {
  const fs::path base = Base();
  RemoveLeftovers(base);
  std::string pattern = (base / (kPrefix + std::to_string(::getpid()) + "-XXXXXX")).string();
  if (::mkdtemp(pattern.data()) == nullptr) return SystemFailure(pattern, "make the folder", errno);
  return PrivateFolder(pattern);
}

PrivateFolder::~PrivateFolder() {
  std::error_code ignored;  // the next run removes it
  if (!path_.empty()) fs::remove_all(path_, ignored);
}

}  // namespace cairn::coordinator
