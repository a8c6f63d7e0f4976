// A transport whose other end is a test that plays the coordinator.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <vector>

#include "worker/transport.h"

namespace cairn::worker {

class FakeTransport : public Transport {
 public:
  // ---- for the worker ----
  std::vector<Event> Poll(double timeout_s) override {
    std::unique_lock lock(mutex_);
    ++polls_;
    polling_ = true;
    changed_.notify_all();
    changed_.wait_for(lock, std::chrono::duration<double>(timeout_s),
                      [this] { return woken_ || !in_.empty(); });
    polling_ = woken_ = false;
    return std::exchange(in_, {});
  }
  bool Send(const wire::Message& message) override {
    const std::lock_guard lock(mutex_);
    if (full_) return false;
    out_.push_back(message);
    changed_.notify_all();
    return true;
  }
  std::uint64_t BytesCame() const override { return bytes_came; }
  void Wake() override {
    const std::lock_guard lock(mutex_);
    woken_ = true;
    changed_.notify_all();
  }

  // ---- for the test ----
  std::atomic<std::uint64_t> bytes_came = 0;
  void Give(Event event) {
    const std::lock_guard lock(mutex_);
    in_.push_back(std::move(event));
    changed_.notify_all();
  }
  void SetFull(bool full) {
    const std::lock_guard lock(mutex_);
    full_ = full;
  }
  // Until the worker has worked off what was given, and was woken up for, so far.
  void AwaitPoll() {
    std::unique_lock lock(mutex_);
    const std::uint64_t enough = polls_ + (polling_ ? 1 : 2);
    woken_ = true;
    changed_.notify_all();
    changed_.wait(lock, [&] { return polls_ >= enough; });
  }
  std::size_t Waiting() {
    const std::lock_guard lock(mutex_);
    return out_.size();
  }
  // The next message that the worker sends; waits for it. Heartbeats are passed over unless they are asked
  // for.
  wire::Message Take(bool heartbeats = false) {
    std::unique_lock lock(mutex_);
    while (true) {
      const bool came = changed_.wait_for(lock, std::chrono::seconds(60), [this] { return !out_.empty(); });
      CAIRN_DEMAND(came, "the worker says nothing");
      wire::Message message = std::move(out_.front());
      out_.pop_front();
      if (heartbeats || !message.envelope.has_heartbeat()) return message;
    }
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool woken_ = false;
  bool full_ = false;
  bool polling_ = false;
  std::uint64_t polls_ = 0;
  std::vector<Event> in_;
  std::deque<wire::Message> out_;
};

}  // namespace cairn::worker
