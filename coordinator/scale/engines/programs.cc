#include "coordinator/scale/engines/programs.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <memory>

#include "schema/text.h"

namespace cairn::coordinator {
namespace {

constexpr std::size_t kMostOutput = 16 << 20;
constexpr int kLook_ms = 20;

// One that runs, and the ends of its pipes that are ours.
class Running {
 public:
  Running(const Program& program, ProgramOutput& output)
      : name_(program.name.empty() ? program.words.at(0) : program.name),
        input_(program.input),
        alone_(program.alone),
        output_(output) {
    Begin(program);
  }
  ~Running() {
    for (int& end : ends_) Close(end);
  }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;

  bool ended() const { return pid_ <= 0; }
  void AddTo(std::vector<pollfd>& polls) const {
    for (std::size_t i = 0; i < ends_.size(); ++i)
      if (ends_[i] >= 0) polls.push_back({ends_[i], static_cast<short>(i == 0 ? POLLOUT : POLLIN), 0});
  }
  void Step() {
    Write();
    Read(ends_[1], output_.out);
    Read(ends_[2], output_.err);
    if (!HasEnded()) return;
    // While its number is nobody else's.
    if (alone_) ::kill(-pid_, SIGKILL);
    int status = 0;
    ::waitpid(pid_, &status, 0);
    // What it left running may hold its pipes open for ever.
    Read(ends_[1], output_.out);
    Read(ends_[2], output_.err);
    pid_ = 0;
    if (WIFEXITED(status)) output_.exit_code = WEXITSTATUS(status);
    if (output_.exit_code != 0) output_.failure = Named(Why(status));
  }
  void Kill(const std::string& why) {
    if (pid_ <= 0) return;
    ::kill(-pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
    pid_ = 0;
    output_.failure = name_ + ": " + why;
  }

 private:
  static void Close(int& end) {
    if (end >= 0) ::close(end);
    end = -1;
  }
  void Begin(const Program& program) {
    std::array<std::array<int, 2>, 3> pipes{};
    for (auto& pipe : pipes) pipe = {-1, -1};
    bool made = false;
    // Its stdin is a socket: who writes to a pipe that nobody reads gets a signal.
    made = ::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pipes[0].data()) == 0;
    for (const std::size_t i : {1U, 2U}) made = made && ::pipe2(pipes[i].data(), O_CLOEXEC) == 0;
    if (made) {
      Spawn(program, pipes);
    } else {
      output_.failure = name_ + ": no pipe: " + std::strerror(errno);
    }
    for (std::size_t i = 0; i < pipes.size(); ++i) {
      Close(pipes[i][i == 0 ? 0 : 1]);
      ends_[i] = pipes[i][i == 0 ? 1 : 0];
      if (ends_[i] >= 0) ::fcntl(ends_[i], F_SETFL, O_NONBLOCK);
    }
    if (input_.empty() || pid_ <= 0) Close(ends_[0]);
  }
  // In a group of its own: Ctrl-C on the terminal is not for it.
  void Spawn(const Program& program, const std::array<std::array<int, 2>, 3>& pipes) {
    std::vector<char*> words;
    for (const std::string& word : program.words) words.push_back(const_cast<char*>(word.c_str()));
    words.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    for (int i = 0; i < 3; ++i)
      posix_spawn_file_actions_adddup2(&actions, pipes[static_cast<std::size_t>(i)][i == 0 ? 0 : 1], i);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t defaults;
    sigemptyset(&defaults);
    sigaddset(&defaults, SIGPIPE);
    posix_spawnattr_setsigdefault(&attributes, &defaults);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF);
    const int failed = ::posix_spawnp(&pid_, words[0], &actions, &attributes, words.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    if (failed == 0) return;
    pid_ = 0;
    output_.failure = name_ + ": " + std::strerror(failed);
  }
  bool HasEnded() const {
    siginfo_t info{};
    return pid_ > 0 && ::waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
           info.si_pid == pid_;
  }
  void Write() {
    while (ends_[0] >= 0) {
      const ssize_t n = ::send(ends_[0], input_.data() + written_, input_.size() - written_, MSG_NOSIGNAL);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0 && errno == EAGAIN) return;
      if (n > 0) written_ += static_cast<std::size_t>(n);
      if (n < 0 || written_ == input_.size()) Close(ends_[0]);
    }
  }
  static void Read(int& end, std::string& text) {
    std::array<char, 1 << 16> buffer{};
    while (end >= 0) {
      const ssize_t n = ::read(end, buffer.data(), buffer.size());
      if (n < 0 && errno == EINTR) continue;
      if (n < 0 && errno == EAGAIN) return;
      if (n <= 0) return Close(end);
      text.append(buffer.data(),
                  std::min(static_cast<std::size_t>(n), kMostOutput - std::min(kMostOutput, text.size())));
    }
  }
  // Most say who they are.
  std::string Named(const std::string& why) const {
    return why.starts_with(name_ + ":") ? why : name_ + ": " + why;
  }
  // The last line that it wrote to its stderr says it best.
  std::string Why(int status) const {
    std::string text = output_.err;
    while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
    text = text.substr(text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1);
    if (!text.empty()) return Printable(text, 300);
    return WIFSIGNALED(status) ? "ended by signal " + std::to_string(WTERMSIG(status))
                               : "exit code " + std::to_string(output_.exit_code);
  }

  const std::string name_;
  const std::string& input_;
  const bool alone_;
  ProgramOutput& output_;
  std::size_t written_ = 0;
  pid_t pid_ = 0;
  std::array<int, 3> ends_ = {-1, -1, -1};  // of its stdin, stdout, stderr
};

std::string NoAnswer(double limit_s) {
  return "no answer for " + std::to_string(std::lround(limit_s)) + " s";
}

}  // namespace

std::vector<ProgramOutput> RunPrograms(const std::vector<Program>& programs, double limit_s,
                                       const std::atomic<bool>* stop) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point end =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(limit_s));
  std::vector<ProgramOutput> outputs(programs.size());
  std::vector<std::unique_ptr<Running>> running;
  for (std::size_t i = 0; i < programs.size(); ++i)
    running.push_back(std::make_unique<Running>(programs[i], outputs[i]));
  const auto goes_on = [&] { return Clock::now() < end && (stop == nullptr || !*stop); };
  while (std::ranges::any_of(running, [](const auto& one) { return !one->ended(); }) && goes_on()) {
    std::vector<pollfd> polls;
    for (const auto& one : running) one->AddTo(polls);
    ::poll(polls.data(), polls.size(), kLook_ms);
    for (const auto& one : running) one->Step();
  }
  const bool stopped = Clock::now() < end;
  for (const auto& one : running) one->Kill(stopped ? "ended before it answered" : NoAnswer(limit_s));
  return outputs;
}

std::string ShellWord(const std::string& text) {
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

}  // namespace cairn::coordinator
