#include "coordinator/local/worker_pool.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>
#include <utility>

namespace cairn::coordinator {
namespace {

constexpr int kExitRefused = 2;  // of cairn-worker
constexpr int kExitCannotExec = 126;

}  // namespace

WorkerPool::~WorkerPool() {
  End(0);
  if (log_ >= 0) ::close(log_);
}

Status WorkerPool::Start() {
  if (::access(options_.program.c_str(), X_OK) != 0)
    return {Code::kNotFound, options_.program + ": " + std::strerror(errno)};
  if (Status status = OpenLog(); !status.ok()) return status;
  places_.resize(static_cast<std::size_t>(std::max(1, options_.workers)));
  for (Place& place : places_) {
    const Result<pid_t> pid = Spawn();
    if (!pid.ok()) return pid.status();
    place.pid = pid.value();
  }
  return Status::Ok();
}

// Without O_NONBLOCK a FIFO would wait for whoever reads from it.
Status WorkerPool::OpenLog() {
  constexpr int kHow = O_WRONLY | O_CREAT | O_APPEND | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK | O_NOCTTY;
  struct stat there{};
  const bool is_file = ::lstat(options_.log_file.c_str(), &there) != 0 || S_ISREG(there.st_mode);
  log_ = is_file ? ::open(options_.log_file.c_str(), kHow, 0600) : -1;
  if (!is_file || (log_ >= 0 && (::fstat(log_, &there) != 0 || !S_ISREG(there.st_mode))))
    return {Code::kRefused,
            options_.log_file.string() + " is no regular file; what workers say goes into one: move it away"};
  return Status::Ok();
}

// Between fork and exec only calls that are safe in a child of a process with threads.
Result<pid_t> WorkerPool::Spawn() const {
  std::vector<std::string> words = {options_.program, "--connect", options_.endpoint, "--die-with-parent"};
  if (options_.task_memory_mb > 0)
    words.push_back("--task-memory-mb=" + std::to_string(options_.task_memory_mb));
  const int inputs_fd = options_.inputs_fd;
  if (inputs_fd >= 0) words.push_back("--inputs-fd=" + std::to_string(inputs_fd));
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const pid_t parent = ::getpid();
  const pid_t pid = ::fork();
  if (pid < 0) return Status(Code::kIo, std::string("cannot start a worker: ") + std::strerror(errno));
  if (pid > 0) return pid;
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(kExitCannotExec);  // it died before that took hold
  if (inputs_fd >= 0) ::fcntl(inputs_fd, F_SETFD, 0);
  ::setpgid(0, 0);  // Ctrl-C on the terminal is for the parent, which ends its workers in good order
  if (log_ >= 0) {
    ::dup2(log_, STDOUT_FILENO);
    ::dup2(log_, STDERR_FILENO);
  }
  ::execv(arguments[0], arguments.data());
  ::_exit(kExitCannotExec);
}

std::vector<WorkerPool::Death> WorkerPool::Reap() {
  std::vector<Death> deaths;
  for (Place& place : places_) {
    int status = 0;
    if (place.pid == 0 || ::waitpid(place.pid, &status, WNOHANG) != place.pid) continue;
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    deaths.push_back({place.pid, code == kExitRefused, WIFSIGNALED(status) ? WTERMSIG(status) : 0,
                      std::exchange(place.killed_here, false)});
    place.pid = 0;
    if (code == kExitCannotExec || place.restarts >= options_.restarts) continue;
    ++place.restarts;
    if (const Result<pid_t> pid = Spawn(); pid.ok()) place.pid = pid.value();
  }
  return deaths;
}

void WorkerPool::Kill(std::int64_t pid) {
  const auto place = std::ranges::find(places_, pid, &Place::pid);
  if (place == places_.end()) return;
  ::kill(place->pid, SIGKILL);
  place->killed_here = true;
}

bool WorkerPool::AllGone() const {
  return std::all_of(places_.begin(), places_.end(), [](const Place& place) { return place.pid == 0; });
}

void WorkerPool::End(double patience_s) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(patience_s);
  while (!AllGone() && std::chrono::steady_clock::now() < end) {
    for (Place& place : places_)
      if (place.pid != 0 && ::waitpid(place.pid, nullptr, WNOHANG) == place.pid) place.pid = 0;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  for (Place& place : places_) {
    if (place.pid == 0) continue;
    ::kill(place.pid, SIGKILL);
    ::waitpid(place.pid, nullptr, 0);
    place.pid = 0;
  }
}

}  // namespace cairn::coordinator
