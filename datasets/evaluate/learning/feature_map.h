// What learned features say of a position: the posterior error of one sample in a map of its features.
#pragma once

#include <cstddef>
#include <numbers>
#include <span>
#include <vector>

#include "schema/geometry.h"

namespace cairn::datasets {

// P(f | xi) at the positions of the training samples.
struct FeatureMap {
  std::vector<Point> positions;
  std::size_t vectors = 1;               // 2^n; bit i of f is f_i
  std::vector<double> probability;       // [positions][vectors]
  std::vector<double> heading_rad = {};  // of the positions; empty where headings do not count
};

// P(f) of independent bits that are 1 with probability g_i: [2^n]. [Thr98] eqs 32, 33.
std::vector<double> FeatureProbabilities(std::span<const double> g);

// P(f | xi) = prod_i of the mean of g_i over the `nearest` samples that were taken closest to xi, itself
// among them ([Thr98] section 5.1.6); of samples equally far away the first ones. `output`:
// [positions][networks]; 1 <= nearest <= positions. `heading_rad`: empty, or of each position; only samples
// that face like xi then count, all of them where they are fewer than `nearest`. Costs O(positions^2).
FeatureMap MapByNearest(const std::vector<Point>& positions, std::span<const double> output,
                        std::size_t networks, std::size_t nearest,
                        const std::vector<double>& heading_rad = {});

// What a robot knows of its heading: positions whose headings are farther away are not believed in.
struct KnownHeading {
  double heading_rad = 0, window_rad = std::numbers::pi;
};

// One sample's share of the errors ([Thr98] eqs 21 and 36, P(a) left out), for a belief that is uniform over
// the positions within a window of where it was taken.
struct WindowError {
  std::size_t positions = 0;      // in the window; all else is meaningless where there are none
  double prior_m = 0;             // mean over the positions of the distance
  double soft_m = 0;              // sum_f P(f | s) E(f), E(f) = sum_xi e P(f | xi) / sum_xi P(f | xi)
  std::vector<double> sampled_m;  // E(f) for each of the drawn f
};

// `windows_m`: half-widths, ascending. `probability`: P(f | s) of the sample, [vectors]. Where the map holds
// f for impossible anywhere in the window the belief stays what it was: E(f) is the prior error. O(positions
// (log positions + vectors)) for all windows together. `known` counts where the map has headings.
std::vector<WindowError> ErrorsInMap(const FeatureMap& map, const Point& truth,
                                     std::span<const double> probability,
                                     const std::vector<std::size_t>& drawn,
                                     const std::vector<double>& windows_m, const KnownHeading& known = {});

}  // namespace cairn::datasets
