// Simulated time: what happens when, in an order that the seed alone decides.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <utility>

namespace cairn::simulation {

class Schedule {
 public:
  double now_s() const { return now_s_; }
  void After(double delay_s, std::function<void()> what) {
    queue_.emplace(std::pair{now_s_ + delay_s, next_++}, std::move(what));
  }
  // Does the next thing; false where there is none.
  bool Step() {
    if (queue_.empty()) return false;
    auto node = queue_.extract(queue_.begin());
    now_s_ = node.key().first;
    node.mapped()();
    return true;
  }

 private:
  double now_s_ = 0;
  std::uint64_t next_ = 0;
  std::map<std::pair<double, std::uint64_t>, std::function<void()>> queue_;
};

}  // namespace cairn::simulation
