// For tests: what sits on the line between a peer and a coordinator. One listens in and tampers, one goes
// dead.
#pragma once

#include <poll.h>

#include <atomic>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "schema/wire/testing/raw_peer.h"

namespace cairn::wire {

// Relays one connection to `port`. What the client sends goes through `tamper` first.
class TamperingRelay {
 public:
  explicit TamperingRelay(int port);
  ~TamperingRelay();
  TamperingRelay(const TamperingRelay&) = delete;
  TamperingRelay& operator=(const TamperingRelay&) = delete;
  const std::string& endpoint() const { return listener_.endpoint(); }
  std::string Heard();  // from the client, so far
  void Tamper(std::function<std::string(std::string)> tamper);

 private:
  void Run();
  bool Pump(int client, int server);
  std::string Hear(std::string bytes);

  const int port_;
  const RawListener listener_;
  std::mutex mutex_;
  std::string heard_;
  std::function<std::string(std::string)> tamper_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

// Between dealers and a router's socket file: what it reads it passes on, or, stalled, throws away. The
// connections stand.
class StallingRelay {
 public:
  StallingRelay(const std::string& listens, const std::string& goes_to);
  ~StallingRelay();
  StallingRelay(const StallingRelay&) = delete;
  StallingRelay& operator=(const StallingRelay&) = delete;
  std::atomic<bool> stalled = false;

 private:
  void Run();
  void Accept();
  void Pass(std::size_t from);

  const std::string to_;
  const RawListener listener_;
  std::vector<pollfd> ends_;  // of one connection at 2k and 2k + 1
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace cairn::wire
