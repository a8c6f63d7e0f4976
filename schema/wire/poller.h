// Waits for sockets, a wakeup from another thread, or the time to run out.
#pragma once

#include <chrono>
#include <memory>

#include "schema/wire/socket.h"

namespace cairn::wire {

// Lets any thread wake up a thread that waits in a Poller.
class Wakeup {
 public:
  Wakeup();
  ~Wakeup();
  Wakeup(const Wakeup&) = delete;
  Wakeup& operator=(const Wakeup&) = delete;
  void Signal() const;  // from any thread, and from a signal handler
  void Clear() const;
  int descriptor() const { return fd_; }  // readable once it is signalled

 private:
  friend class Poller;
  int fd_;
};

// All that is added must outlive the poller, and stay in place.
class Poller {
 public:
  Poller();
  ~Poller();
  Poller(const Poller&) = delete;
  Poller& operator=(const Poller&) = delete;
  void Add(RouterSocket& socket);
  void Add(DealerSocket& socket);
  void Add(const Wakeup& wakeup);
  // True where something came before `timeout` was over. Then drain: TryEvent and TryReceive until they give
  // nothing. Clears the wakeups. A signal ends the wait early, with false, and so does the time at which a
  // dealer must be asked whether anything comes.
  bool Wait(std::chrono::milliseconds timeout);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cairn::wire
