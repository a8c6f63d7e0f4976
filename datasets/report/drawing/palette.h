// Colours of pictures on white paper.
#pragma once

#include <array>
#include <cmath>

namespace cairn::datasets::report {

using Rgb = std::array<int, 3>;

inline constexpr Rgb kPaper{255, 255, 255}, kInk{28, 39, 51}, kSoft{91, 107, 123}, kBlack{0, 0, 0};
inline constexpr Rgb kTint{143, 184, 232}, kDensity{36, 70, 120};
inline constexpr std::size_t kRobotColours = 8;  // robots beyond them begin again

// `share` of b in a.
inline Rgb Mix(Rgb a, Rgb b, double share) {
  Rgb mixed{};
  for (std::size_t c = 0; c < 3; ++c) mixed[c] = static_cast<int>(std::lround(a[c] + share * (b[c] - a[c])));
  return mixed;
}

// Of cells of which nothing is known: bluish, as no probability is.
inline constexpr Rgb kUnknown{178, 196, 218};

// A cell's probability of being occupied, in greys: white is free, black is occupied, and down to one half,
// whose grey this is, nothing is as dark as what is unknown.
inline constexpr Rgb kEvenChance{220, 220, 220};
inline Rgb OfProbability(double p) {
  if (std::isnan(p)) return kUnknown;
  return p <= 0.5 ? Mix(kPaper, kEvenChance, 2 * p) : Mix(kEvenChance, kBlack, 2 * p - 1);
}

}  // namespace cairn::datasets::report
