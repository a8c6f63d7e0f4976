#include "datasets/evaluate/matching/point_match.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "datasets/evaluate/matching/assignment.h"

namespace cairn::datasets {
namespace {

// Of a point the truths within the cut-off, the nearest of them where there are very many. With alpha = 2 a
// pair at the cut-off costs as much as one missed and one spurious point, so that it need not come into
// question.
std::vector<PairCost> PairsOf(const Point& point, const std::vector<std::pair<double, std::size_t>>& by_x,
                              const std::vector<Point>& truth, const std::function<bool(std::size_t)>& may,
                              double cut_off_m) {
  constexpr std::size_t kMost = 64;
  std::vector<PairCost> pairs;
  for (auto at = std::ranges::lower_bound(by_x, std::pair<double, std::size_t>{point.x_m - cut_off_m, 0});
       at != by_x.end() && at->first < point.x_m + cut_off_m; ++at) {
    const double distance = DistanceM(point, truth[at->second]);
    if (distance < cut_off_m && may(at->second)) pairs.push_back({at->second, distance * distance});
  }
  const auto nearer = [](const PairCost& a, const PairCost& b) {
    return std::pair(a.cost, a.column) < std::pair(b.cost, b.column);
  };
  if (pairs.size() > kMost) {
    std::ranges::nth_element(pairs, pairs.begin() + kMost, nearer);
    pairs.resize(kMost);
  }
  std::ranges::sort(pairs, nearer);
  return pairs;
}

}  // namespace

PointMatch MatchPoints(const std::vector<Point>& estimate, const std::vector<Point>& truth,
                       const MayMatch& may_match, double cut_off_m) {
  std::vector<std::pair<double, std::size_t>> by_x;
  for (std::size_t t = 0; t < truth.size(); ++t) by_x.emplace_back(truth[t].x_m, t);
  std::ranges::sort(by_x);
  std::vector<std::vector<PairCost>> costs;
  for (std::size_t e = 0; e < estimate.size(); ++e)
    costs.push_back(
        PairsOf(estimate[e], by_x, truth, [&](std::size_t t) { return may_match(e, t); }, cut_off_m));
  const auto column_of = AssignOptimally(costs, truth.size(), cut_off_m * cut_off_m);
  PointMatch match;
  double squares = 0;
  for (std::size_t e = 0; e < estimate.size(); ++e) {
    if (!column_of[e]) continue;
    match.pairs.emplace_back(e, *column_of[e]);
    squares += std::ranges::find(costs[e], *column_of[e], &PairCost::column)->cost;
  }
  const auto unmatched = static_cast<double>(estimate.size() + truth.size() - 2 * match.pairs.size());
  match.gospa_m = std::sqrt(squares + cut_off_m * cut_off_m / 2 * unmatched);
  return match;
}

}  // namespace cairn::datasets
