// How much of a count is left after a number of sweeps, from a table.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace cairn::local_map {

// `kept`: the fraction that is kept each sweep, in [0, 1). What is less than a millionth is nothing.
class Decay {
 public:
  explicit Decay(double kept) : kept_(kept) {
    for (double left = 1; left > 1e-6; left *= kept) left_.push_back(static_cast<float>(left));
    left_.push_back(0);
  }
  double kept() const { return kept_; }
  float After(std::int32_t sweeps) const {
    const auto n = static_cast<std::size_t>(sweeps);
    return left_[n < left_.size() ? n : left_.size() - 1];
  }

 private:
  double kept_;
  std::vector<float> left_;
};

}  // namespace cairn::local_map
