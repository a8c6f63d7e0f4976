// For tests: what sits on the line between a peer and a coordinator. One listens in and tampers, one goes
// dead.
#pragma once

#include <poll.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
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

// Between dealers and a router: what it reads it passes on, or, stalled, throws away. The connections stand.
class StallingRelay {
 public:
  StallingRelay(const std::string& listens, const std::string& goes_to);  // socket files
  explicit StallingRelay(int port);  // from a port of its own to that one
  ~StallingRelay();
  StallingRelay(const StallingRelay&) = delete;
  StallingRelay& operator=(const StallingRelay&) = delete;
  const std::string& endpoint() const { return listener_.endpoint(); }
  std::atomic<bool> stalled = false;
  // Bytes of the router's; once it has passed so many on, it is stalled.
  std::atomic<std::uint64_t> passed = 0, most = std::numeric_limits<std::uint64_t>::max();
  // Of the router's bytes no more than these are read: the others wait, as over a slow link.
  std::atomic<std::uint64_t> may_pass = std::numeric_limits<std::uint64_t>::max();
  // Ends the connections. Those that come next are not stalled.
  void Break() { breaks_ = true; }

 private:
  void Run();
  void Accept();
  void Pass(std::size_t from);
  void CloseAll();

  const std::function<int()> connect_;
  const RawListener listener_;
  std::vector<pollfd> ends_;  // of one connection at 2k, the router's at 2k + 1
  std::atomic<bool> breaks_{false}, stop_{false};
  std::thread thread_;
};

}  // namespace cairn::wire
