// One-to-one matching of estimated to true points, and the GOSPA metric that comes of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "schema/geometry.h"

namespace cairn::datasets {

inline constexpr double kCutOffM = 3;

struct PointMatch {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  // (estimate, truth), closer than the cut-off
  double gospa_m = 0;
};

// May this estimate be that truth? For points that have identities.
using MayMatch = std::function<bool(std::size_t estimate, std::size_t truth)>;

// Minimises, over all one-to-one matchings within the cut-off c, the square of
//   gospa = sqrt(sum over matched of d^2 + (c^2 / 2) (missed + spurious)),
// A. S. Rahmathullah, A. F. Garcia-Fernandez and L. Svensson, Generalized optimal sub-pattern assignment
// metric, FUSION 2017, eq. 1 with p = 2 and alpha = 2.
PointMatch MatchPoints(const std::vector<Point>& estimate, const std::vector<Point>& truth,
                       const MayMatch& may_match, double cut_off_m = kCutOffM);

}  // namespace cairn::datasets
