// The middle one of many numbers, in little memory.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace cairn {

// Of n numbers that with n / 2 smaller ones, or as small; of fewer than `few` nothing. `each(take)` calls
// take(number) for each of them, none NaN; it is called several times, and always gives the same.
template <class Each>
std::optional<double> MiddleOf(const Each& each, std::size_t few = 1) {
  constexpr int kDigits = 16;
  constexpr std::uint64_t kSign = std::uint64_t{1} << 63, kDigit = (1 << kDigits) - 1;
  // Whole numbers in the order of the others (IEEE 754).
  const auto in_order = [](double number) {
    const auto bits = std::bit_cast<std::uint64_t>(number);
    return (bits & kSign) != 0 ? ~bits : bits | kSign;
  };
  std::size_t count = 0;
  each([&](double) { ++count; });
  if (count < few || count == 0) return std::nullopt;
  std::size_t smaller = count / 2;
  std::uint64_t known = 0, which = 0;  // its first digits, and where they are
  for (int shift = 64 - kDigits; shift >= 0; shift -= kDigits) {
    std::vector<std::size_t> counts(kDigit + 1, 0);
    each([&](double number) {
      const std::uint64_t bits = in_order(number);
      if ((bits & which) == known) ++counts[bits >> shift & kDigit];
    });
    std::uint64_t digit = 0;
    while (counts[digit] <= smaller) smaller -= counts[digit++];
    known |= digit << shift;
    which |= kDigit << shift;
  }
  return std::bit_cast<double>((known & kSign) != 0 ? known ^ kSign : ~known);
}

// The middle one of the pauses between times that rise.
std::optional<double> MiddlePause(const auto& time_s, std::size_t few) {
  return MiddleOf(
      [&](const auto& take) {
        for (std::size_t i = 1; i < time_s.size(); ++i)
          if (time_s[i] > time_s[i - 1]) take(time_s[i] - time_s[i - 1]);
      },
      few);
}

}  // namespace cairn
