// How much of a count is left after some time, from a table.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace cairn::local_map {

// Time goes in ticks. What is said a scan, decay rates and frequencies, is said of the paper's, five a
// second: rings that are read more or less often mean the same by it, as if what they read stood until the
// next time.
inline constexpr int kTicksPerScan = 4;
inline constexpr double kTickS = 0.05;

// `kept`: the fraction that is kept each scan, in [0, 1). What is less than a millionth is nothing.
class Decay {
 public:
  explicit Decay(double kept) : kept_(kept) {
    const double kept_a_tick = std::sqrt(std::sqrt(kept));
    for (double left = 1; left > 1e-6; left *= kept_a_tick) left_.push_back(static_cast<float>(left));
    left_.push_back(0);
  }
  double kept() const { return kept_; }
  float After(std::int32_t ticks) const {
    const auto n = static_cast<std::size_t>(ticks);
    return left_[n < left_.size() ? n : left_.size() - 1];
  }
  // What a reading adds to a count that stands for so many ticks: 1 for a scan. It stands for three seconds
  // at most.
  float Weight(std::int32_t ticks) const {
    constexpr std::int32_t kMost = 60;
    return static_cast<float>((1 - static_cast<double>(After(ticks < kMost ? ticks : kMost))) / (1 - kept_));
  }

 private:
  double kept_;
  std::vector<float> left_;
};

}  // namespace cairn::local_map
