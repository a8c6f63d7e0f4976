#include "coordinator/cli/common/run_page.h"

#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <vector>

#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/programs.h"

namespace cairn::cli {

// In a group of its own: Ctrl-C on the terminal is for the run, which ends its page.
RunPage::RunPage(const std::string& endpoint, const std::string& dir) : pid_(0) {
  std::vector<std::string> words = {PageProgramPath(), "--connect=" + endpoint, "--read-only",
                                    "--die-with-parent", "--run=" + std::filesystem::absolute(dir).string()};
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  const int failed = ::posix_spawn(&pid_, arguments[0], &actions, &attributes, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  if (failed != 0) throw WorldError(words[0] + " cannot be run: " + std::strerror(failed));
}

RunPage::~RunPage() {
  ::kill(pid_, SIGTERM);
  while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

}  // namespace cairn::cli
