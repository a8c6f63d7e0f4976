#include "datasets/evaluate/matching/point_match.h"

#include <algorithm>
#include <cmath>

#include "datasets/evaluate/matching/assignment.h"

namespace cairn::datasets {
namespace {

// Square cost matrix: with alpha = 2 a pair at the cut-off costs as much as one missed and one spurious
// point, so capped pairs and padding say the same.
std::vector<std::vector<double>> Costs(const std::vector<Point>& estimate, const std::vector<Point>& truth,
                                       const MayMatch& may_match, double cut_off_m) {
  const std::size_t size = std::max(estimate.size(), truth.size());
  const double unmatched = cut_off_m * cut_off_m / 2;
  std::vector<std::vector<double>> costs(size, std::vector<double>(size, unmatched));
  for (std::size_t e = 0; e < estimate.size(); ++e) {
    for (std::size_t t = 0; t < truth.size(); ++t) {
      const double distance = may_match(e, t) ? DistanceM(estimate[e], truth[t]) : cut_off_m;
      costs[e][t] = std::min(distance * distance, cut_off_m * cut_off_m);
    }
  }
  return costs;
}

}  // namespace

PointMatch MatchPoints(const std::vector<Point>& estimate, const std::vector<Point>& truth,
                       const MayMatch& may_match, double cut_off_m) {
  const auto costs = Costs(estimate, truth, may_match, cut_off_m);
  const std::vector<std::size_t> column_of = AssignOptimally(costs);
  PointMatch match;
  double squares = 0;
  for (std::size_t e = 0; e < estimate.size(); ++e) {
    const std::size_t t = column_of[e];
    if (t >= truth.size() || costs[e][t] >= cut_off_m * cut_off_m) continue;
    match.pairs.emplace_back(e, t);
    squares += costs[e][t];
  }
  const auto unmatched = static_cast<double>(estimate.size() + truth.size() - 2 * match.pairs.size());
  match.gospa_m = std::sqrt(squares + cut_off_m * cut_off_m / 2 * unmatched);
  return match;
}

}  // namespace cairn::datasets
