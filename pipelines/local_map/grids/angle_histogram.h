// A histogram of the directions of lines, which repeat after a period, in eight bins.
#pragma once

#include <array>
#include <cmath>

#include "pipelines/local_map/grids/plane.h"

namespace cairn::local_map {

inline constexpr int kAngleBins = 8;

// Bin k is centred on k / 8 of the period.
struct AngleHistogram {
  std::array<float, kAngleBins> bin{};

  // Shared by the two nearest bins by how near they are, so that the histogram's mean is that of the angles.
  void Add(double angle_rad, double period_rad, float weight) {
    const double at = ModuloAngle(angle_rad, period_rad) / period_rad * kAngleBins;  // in [-4, 4]
    const double below = std::floor(at);
    const auto share = static_cast<float>(at - below);
    const auto k = static_cast<unsigned>(static_cast<int>(below) + kAngleBins);
    bin[k % kAngleBins] += weight * (1 - share);
    bin[(k + 1) % kAngleBins] += weight * share;
  }
  void Scale(float by) {
    for (float& b : bin) b *= by;
  }
  float Total() const {
    float total = 0;
    for (const float b : bin) total += b;
    return total;
  }
  // All angles become larger by `angle_rad`; bins are shared as in Add.
  void Shift(double angle_rad, double period_rad) {
    AngleHistogram shifted;
    for (int k = 0; k < kAngleBins; ++k)
      shifted.Add(k * period_rad / kAngleBins + angle_rad, period_rad, bin[static_cast<std::size_t>(k)]);
    *this = shifted;
  }
};

struct AnglePeak {
  double angle_rad = 0;  // in [-period / 2, period / 2]
  double strength = 0;   // share of the weight in the three bins of the peak, of all; 3/8 if all are alike
  double weight = 0;     // of all bins
};

// The bin with the most weight, its neighbours' by half, and the mean of the three once what is common to all
// bins is taken off. No weight at all: angle 0, strength 0.
AnglePeak PeakOf(const AngleHistogram& histogram, double period_rad);

}  // namespace cairn::local_map
