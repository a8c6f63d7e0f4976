// A ring of 24 sonars at half the height of a trash bin.
#pragma once

#include <vector>

#include "datasets/simulate/corridor/scene.h"

namespace cairn::datasets::corridor {

inline constexpr double kSonarHeightM = 0.45;

// [kSonars], of datasets/simulate/sonar.h: the nearest surface in a cone, with noise. Where there is no echo
// (nothing near enough, or by chance) the largest range, as an input of a network must be a number.
std::vector<float> SonarRanges(const Scene& scene, const Snapshot& snapshot, Rng& rng);

}  // namespace cairn::datasets::corridor
