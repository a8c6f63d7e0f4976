// Colours of pictures in files: the report's, on white paper.
#pragma once

#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "datasets/report/drawing/canvas.h"

namespace cairn::datasets::report {

inline constexpr Rgb kPaper{255, 255, 255}, kInk{28, 39, 51}, kSoft{91, 107, 123}, kLine{205, 213, 221};
inline constexpr Rgb kRaster{233, 238, 242}, kTruePathGrey{214, 219, 225}, kTruth{133, 147, 161},
    kBad{179, 38, 30};
inline constexpr Rgb kTint{143, 184, 232}, kBlack{0, 0, 0};
inline constexpr Rgb kDensity{36, 70, 120};
inline constexpr std::size_t kRobotColours = 8;  // robots beyond them begin again
inline constexpr std::array<Rgb, kRobotColours> kRobots = {{{31, 111, 181},
                                                            {210, 96, 26},
                                                            {22, 134, 92},
                                                            {160, 79, 184},
                                                            {14, 147, 166},
                                                            {181, 54, 94},
                                                            {138, 116, 17},
                                                            {85, 96, 200}}};

// "#1f6fb5"
inline std::string Hex(Rgb colour) {
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", colour[0] & 0xFF, colour[1] & 0xFF, colour[2] & 0xFF);
  return text;
}

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
