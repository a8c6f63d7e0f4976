#include "coordinator/scale/engines/tunnels.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace cairn::coordinator {

Tunnels::Tunnels(std::vector<std::vector<std::string>> commands, LogSink log) : log_(std::move(log)) {
  for (std::vector<std::string>& words : commands) tunnels_.push_back({std::move(words), 0, {}});
}

Tunnels::~Tunnels() {
  for (const Tunnel& tunnel : tunnels_) {
    if (tunnel.pid <= 0) continue;
    ::kill(tunnel.pid, SIGTERM);
    ::waitpid(tunnel.pid, nullptr, 0);
  }
}

void Tunnels::Keep() {
  for (Tunnel& tunnel : tunnels_) {
    if (tunnel.pid > 0 && ::waitpid(tunnel.pid, nullptr, WNOHANG) == tunnel.pid) {
      log_(Severity::kWarning, "the tunnel of '" + tunnel.words.back() + "' has ended; it is opened again");
      tunnel.pid = 0;
    }
    if (tunnel.pid == 0 && (tunnel.tried == Clock::time_point{} || Clock::now() - tunnel.tried >= kAgain))
      Open(tunnel);
  }
}

// Between fork and exec only calls that are safe in a child of a process with threads. It dies with this
// process, and Ctrl-C on the terminal is not for it.
void Tunnels::Open(Tunnel& tunnel) {
  tunnel.tried = Clock::now();
  std::vector<char*> words;
  for (std::string& word : tunnel.words) words.push_back(word.data());
  words.push_back(nullptr);
  const pid_t parent = ::getpid();
  const pid_t pid = ::fork();
  if (pid < 0) return log_(Severity::kWarning, std::string("no tunnel: ") + std::strerror(errno));
  if (pid > 0) {
    tunnel.pid = pid;
    return;
  }
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (::getppid() != parent) ::_exit(1);
  ::setpgid(0, 0);
  const int nowhere = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  for (const int end : {STDIN_FILENO, STDOUT_FILENO}) ::dup2(nowhere, end);
  ::execvp(words[0], words.data());
  ::_exit(127);
}

}  // namespace cairn::coordinator
