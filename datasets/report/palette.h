// Colours of pictures in files: the report's, on white paper.
#pragma once

#include <array>
#include <cmath>

#include "datasets/report/canvas.h"
#include "datasets/report/figures.h"

namespace cairn::datasets::report {

inline constexpr Rgb kPaper{255, 255, 255}, kInk{28, 39, 51}, kSoft{91, 107, 123}, kLine{205, 213, 221};
inline constexpr Rgb kRaster{233, 238, 242}, kTruePathGrey{214, 219, 225}, kTruth{133, 147, 161},
    kBad{179, 38, 30};
inline constexpr Rgb kTint{143, 184, 232}, kBlack{0, 0, 0}, kUnknown{205, 205, 205};
inline constexpr Rgb kDensity{36, 70, 120};
inline constexpr std::array<Rgb, kRobotColours> kRobots = {{{31, 111, 181},
                                                            {210, 96, 26},
                                                            {22, 134, 92},
                                                            {160, 79, 184},
                                                            {14, 147, 166},
                                                            {181, 54, 94},
                                                            {138, 116, 17},
                                                            {85, 96, 200}}};

// `share` of b in a.
inline Rgb Mix(Rgb a, Rgb b, double share) {
  Rgb mixed{};
  for (std::size_t c = 0; c < 3; ++c) mixed[c] = static_cast<int>(std::lround(a[c] + share * (b[c] - a[c])));
  return mixed;
}

}  // namespace cairn::datasets::report
