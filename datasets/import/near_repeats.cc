#include "datasets/import/near_repeats.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace cairn::datasets {
namespace {

// How many digits behind the point a number needs.
int DigitsOf(double value) {
  constexpr int kMost = 9;
  constexpr double kRounding = 4e-16;  // of a double
  double unit = 1;
  for (int digits = 0; digits < kMost; ++digits, unit *= 10)
    if (const double scaled = std::abs(value) * unit;
        std::abs(scaled - std::nearbyint(scaled)) <= kRounding * scaled + 1e-9)
      return digits;
  return kMost;
}

double HalfUnit(int digits) { return 0.5000001 * std::pow(10.0, -digits); }

class StepPairs {
 public:
  explicit StepPairs(const Odometry& odometry) : odometry_(odometry) {}

  // Of each other's time, and the one the other with fewer digits.
  bool AreNear(std::size_t a, std::size_t b) const {
    return (IsRoundedTime(a, b) && IsRounded(a, b)) || (IsRoundedTime(b, a) && IsRounded(b, a));
  }
  bool SayTheSame(std::size_t a, std::size_t b) const { return IsRounded(a, b) || IsRounded(b, a); }

 private:
  bool IsRoundedTime(std::size_t coarse, std::size_t fine) const {
    const double time_s = odometry_.time_s[coarse];
    return std::abs(time_s - odometry_.time_s[fine]) <= HalfUnit(DigitsOf(time_s));
  }
  // One digit of a way tells nothing, nor does a turn of 0, but with the digits of the way.
  bool IsRounded(std::size_t coarse, std::size_t fine) const {
    const double turn_rad = odometry_.turn_rad[coarse], forward_m = odometry_.forward_m[coarse];
    const int of_forward = DigitsOf(forward_m), of_turn = std::max(DigitsOf(turn_rad), of_forward - 1);
    return of_forward >= 2 && std::abs(forward_m) >= 20 * HalfUnit(of_forward) &&
           std::abs(turn_rad - odometry_.turn_rad[fine]) <= HalfUnit(of_turn) &&
           std::abs(forward_m - odometry_.forward_m[fine]) <= HalfUnit(of_forward);
  }

  const Odometry& odometry_;
};

}  // namespace

std::string DoubtNearRepeats(const Odometry& odometry) {
  constexpr std::size_t kLeastRun = 5, kOftener = 4;
  const std::size_t rows = odometry.time_s.size();
  const StepPairs steps(odometry);
  std::size_t pairs = 0, same_behind = 0, first = 0;
  for (std::size_t i = 0; i + 1 < rows;) {
    std::size_t run = 0, same = 0;
    for (; i + 1 < rows && steps.AreNear(i, i + 1); i += 2, ++run)
      if (i + 2 < rows && steps.SayTheSame(i, i + 2)) ++same;
    if (run >= kLeastRun) {
      if (pairs == 0) first = i - 2 * run;
      pairs += run;
      same_behind += same;
    }
    if (run == 0) ++i;
  }
  if (pairs == 0 || kOftener * same_behind > pairs) return "";
  const auto line = [&](std::size_t row) { return std::to_string(odometry.from.line[row]); };
  return "at least " + std::to_string(pairs) + " of " + std::to_string(rows) +
         " rows say the same as the row beside them, with other digits (the first: lines " + line(first) +
         " and " + line(first + 1) +
         "). Where files that overlap were put together, which two programs wrote, these steps count twice: "
         "leave the overlap out of one of them";
}

}  // namespace cairn::datasets
