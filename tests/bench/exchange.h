// Requests and answers, timed; who waits for one that never comes is told what it was, and not left to wait.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "schema/wire/poller.h"
#include "schema/wire/socket.h"

namespace cairn::bench {

inline double Seconds(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

// While it lives, `what` has to come at least once in `patience`: else the program ends, and says so.
class Awaited {
 public:
  explicit Awaited(std::string what, std::chrono::seconds patience = std::chrono::seconds(60))
      : what_(std::move(what)), patience_(patience), thread_([this] { Watch(); }) {}
  ~Awaited() {
    {
      const std::lock_guard lock(mutex_);
      over_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }
  Awaited(const Awaited&) = delete;
  Awaited& operator=(const Awaited&) = delete;
  void Came() { came_.fetch_add(1, std::memory_order_relaxed); }

 private:
  void Watch() {
    std::unique_lock lock(mutex_);
    for (std::uint64_t seen = came_; !changed_.wait_for(lock, patience_, [this] { return over_; });) {
      const std::uint64_t came = came_;
      if (came == seen) {
        std::fprintf(stderr, "waited %lld s in vain for %s; %llu came before\n",
                     static_cast<long long>(patience_.count()), what_.c_str(),
                     static_cast<unsigned long long>(came));
        std::_Exit(1);
      }
      seen = came;
    }
  }

  const std::string what_;
  const std::chrono::seconds patience_;
  std::atomic<std::uint64_t> came_{0};
  std::mutex mutex_;
  std::condition_variable changed_;
  bool over_ = false;
  std::thread thread_;
};

// `count` requests with at most `in_flight` unanswered, in requests a second.
inline double Rate(Awaited& answers, int count, int in_flight, const std::function<void()>& ask,
                   const std::function<void()>& take) {
  const double seconds = Seconds([&] {
    int asked = 0;
    for (int taken = 0; taken < count; ++taken) {
      for (; asked < count && asked - taken < in_flight; ++asked) ask();
      take();
      answers.Came();
    }
  });
  return count / seconds;
}

inline void TakeEvents(wire::DealerSocket& dealer) {
  while (dealer.TryEvent()) {
  }
}

// Once the dealer is connected, which its events tell, and its queue has room.
inline void SendOver(wire::DealerSocket& dealer, wire::Poller& poller, const wire::Message& message) {
  for (TakeEvents(dealer); !dealer.Send(message).ok(); TakeEvents(dealer))
    poller.Wait(std::chrono::milliseconds(1));
}

}  // namespace cairn::bench
