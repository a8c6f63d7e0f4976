#include "coordinator/page/helper.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <stdexcept>
#include <system_error>
#include <thread>

#include "schema/error.h"
#include "schema/store/atomic_file.h"
#include "schema/store/regular_file.h"
#include "schema/text.h"

namespace cairn::page {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostPrinted_bytes = 4 << 20;
constexpr int kBadInput = 2;  // its exit code

// A descriptor that holds the lock; -1: another process does.
int LockFolder(const fs::path& folder) {
  const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (fd >= 0 && ::flock(fd, LOCK_EX | LOCK_NB) == 0) return fd;
  if (fd >= 0) ::close(fd);
  return -1;
}

// Those of processes that are no more.
void RemoveOld(const fs::path& base) {
  std::error_code error;
  for (fs::directory_iterator it(base, error), end; !error && it != end; it.increment(error)) {
    const int lock = LockFolder(it->path());
    if (lock < 0) continue;
    std::error_code ignored;
    fs::remove_all(it->path(), ignored);
    ::close(lock);
  }
}

std::string TextOf(const fs::path& file) {
  const Result<std::string> text = ReadSmallFile(file, kMostPrinted_bytes);
  return text.ok() ? text.value() : "";
}

// The last line of what a program said, without its name.
std::string LastLine(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  text = text.substr(text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1);
  const std::string name = "cairn: ";
  return Printable(text.starts_with(name) ? text.substr(name.size()) : text, 1000);
}

// Also those that are being written, under other names.
bool IsTooMuch(const Most& most) {
  if (most.results_in.empty()) return false;
  std::uint64_t bytes = 0;
  std::error_code error;
  for (fs::directory_iterator it(most.results_in, error), end; !error && it != end; it.increment(error)) {
    std::error_code gone;
    const bool counts = it->path().filename().string().find(".h5") != std::string::npos;
    const std::uintmax_t size = counts ? it->file_size(gone) : 0;
    if (!gone) bytes += size;
  }
  return bytes > most.results_bytes;
}

enum class Ending { kItself, kTime, kResults };

// Whatever takes more is ended, with all that it started.
Ending WaitFor(pid_t pid, const Most& most, int* status) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(most.time_s);
  Ending how = Ending::kItself;
  while (how == Ending::kItself) {
    const pid_t ended = ::waitpid(pid, status, WNOHANG);
    if (ended == pid || (ended < 0 && errno != EINTR)) return IsTooMuch(most) ? Ending::kResults : how;
    if (std::chrono::steady_clock::now() > end) how = Ending::kTime;
    if (IsTooMuch(most)) how = Ending::kResults;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  ::kill(-pid, SIGKILL);
  while (::waitpid(pid, status, 0) < 0 && errno == EINTR) {
  }
  return how;
}

// Under a limit a shell sets that before it becomes the program.
std::vector<std::string> UnderLimit([[maybe_unused]] std::uint64_t memory_bytes) {
#ifndef CAIRN_SANITIZED  // the sanitizers take what they take
  if (memory_bytes > 0)
    return {"/bin/sh", "-c", "ulimit -v " + std::to_string(memory_bytes / 1024) + " && exec \"$0\" \"$@\""};
#endif
  return {};
}

}  // namespace

OwnFolder::OwnFolder(const fs::path& base) {
  std::error_code error;
  fs::create_directories(base, error);
  RemoveOld(base);
  std::string pattern = (base / "XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr)
    throw std::runtime_error(SystemFailure(base, "make a folder in it", errno).message());
  path_ = pattern;
  lock_ = LockFolder(path_);
}

OwnFolder::~OwnFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  if (lock_ >= 0) ::close(lock_);
}

void Helper::End() {
  ending_ = true;
  if (const pid_t pid = running_; pid > 0) ::kill(-pid, SIGKILL);
}

Helper::Outcome Helper::Run(const std::vector<std::string>& words, const Most& most, const fs::path& in) {
  const fs::path said = folder_ / "said", printed = folder_ / "printed";
  std::vector<std::string> all = UnderLimit(most.memory_bytes);
  all.push_back(program_);
  all.insert(all.end(), words.begin(), words.end());
  std::vector<char*> arguments;
  for (std::string& word : all) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  const auto into = [&actions](int fd, const fs::path& file) {
    posix_spawn_file_actions_addopen(&actions, fd, file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  };
  into(STDOUT_FILENO, printed);
  into(STDERR_FILENO, said);
  if (!in.empty()) posix_spawn_file_actions_addchdir_np(&actions, in.c_str());
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setpgroup(&attributes, 0);  // Ctrl-C on the terminal is not for it
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  pid_t pid = 0;
  const int failed = ::posix_spawn(&pid, all[0].c_str(), &actions, &attributes, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  if (failed != 0) return {.printed = "", .trouble = program_ + " cannot be run: " + std::strerror(failed)};
  running_ = pid;
  if (ending_) ::kill(-pid, SIGKILL);
  int status = 0;
  const Ending how = WaitFor(pid, most, &status);
  running_ = 0;
  Outcome outcome{.printed = TextOf(printed), .trouble = ""};
  outcome.too_large = how == Ending::kResults;
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0 && !outcome.too_large) return outcome;
  outcome.bad_input = WIFEXITED(status) && WEXITSTATUS(status) == kBadInput;
  outcome.trouble = how == Ending::kItself ? LastLine(TextOf(said))
                    : how == Ending::kTime ? "it took too long, and was ended"
                                           : "its results are too large, and it was ended";
  if (outcome.trouble.empty()) outcome.trouble = "it ended without saying why";
  return outcome;
}

}  // namespace cairn::page
