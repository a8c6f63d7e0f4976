// For hosts from which the coordinator cannot be reached: a port of theirs, at their loopback, that leads to
// it through ssh.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <string>
#include <vector>

#include "coordinator/store/log.h"

namespace cairn::coordinator {

class Tunnels {
 public:
  // Of each: the words that hold it open until they are killed.
  Tunnels(std::vector<std::vector<std::string>> commands, LogSink log);
  ~Tunnels();  // ends them
  Tunnels(const Tunnels&) = delete;
  Tunnels& operator=(const Tunnels&) = delete;

  // Opens those that are not open, at most every `kAgain` each.
  void Keep();

  static constexpr std::chrono::seconds kAgain{5};

 private:
  using Clock = std::chrono::steady_clock;
  struct Tunnel {
    std::vector<std::string> words;
    pid_t pid = 0;
    Clock::time_point tried{};
  };
  void Open(Tunnel& tunnel);

  std::vector<Tunnel> tunnels_;
  const LogSink log_;
};

}  // namespace cairn::coordinator
