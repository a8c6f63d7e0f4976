// What waits for somebody else, done one after another by a thread of its own.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace cairn::page {

class Errands {
 public:
  explicit Errands(std::size_t most) : most_(most), thread_([this] { Run(); }) {}
  ~Errands() { Stop(); }
  // What waits is forgotten; what is being done is waited for.
  void Stop() {
    {
      const std::lock_guard lock(mutex_);
      ending_ = true;
      waiting_.clear();
    }
    changed_.notify_one();
    if (thread_.joinable()) thread_.join();
  }
  Errands(const Errands&) = delete;
  Errands& operator=(const Errands&) = delete;

  // False: too much waits already.
  bool Add(std::function<void()> errand) {
    const std::lock_guard lock(mutex_);
    if (ending_ || waiting_.size() >= most_) return false;
    waiting_.push_back(std::move(errand));
    changed_.notify_one();
    return true;
  }

 private:
  void Run() {
    for (std::unique_lock lock(mutex_);;) {
      changed_.wait(lock, [this] { return ending_ || !waiting_.empty(); });
      if (ending_) return;
      const std::function<void()> errand = std::move(waiting_.front());
      waiting_.pop_front();
      lock.unlock();
      errand();
      lock.lock();
    }
  }

  const std::size_t most_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> waiting_;
  bool ending_ = false;
  std::thread thread_;  // the last to begin
};

}  // namespace cairn::page
