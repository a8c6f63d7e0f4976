#include "datasets/import/time_digits.h"

namespace cairn::datasets {

void TimeDigits::Add(double time_s) {
  ++rows_;
  if (times_ == 0) first_s_ = time_s;
  if (times_ == 0 || time_s != last_s_) ++times_;
  last_s_ = time_s;
}

std::string TimeDigits::Doubt() const {
  constexpr std::size_t kFewRows = 20, kRowsATime = 50;
  constexpr double kPause_s = 5;  // whole seconds are digits enough
  if (rows_ < kFewRows) return {};
  if (times_ > 1 && rows_ < kRowsATime * times_) return {};
  if (times_ > 1 && last_s_ - first_s_ < kPause_s * static_cast<double>(times_ - 1)) return {};
  return std::to_string(rows_) + " rows have " + std::to_string(times_) + (times_ == 1 ? " time" : " times") +
         ": were they written with too few digits?";
}

}  // namespace cairn::datasets
