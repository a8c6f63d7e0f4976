#include "datasets/evaluate/matching/align.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cairn::datasets {
namespace {

constexpr double kLengthToleranceM = 1.5;  // between two points' distances, estimated and true
constexpr double kMinBaselineM = 2;        // shorter pairs say nothing about the rotation
constexpr std::size_t kMaxStarts = 1000000;
constexpr std::size_t kImproved = 20;  // starts that are improved
constexpr int kMaxRounds = 50;

struct Start {
  double cost = 0;
  std::size_t order = 0;  // in which it was found: ties go to the first
  Similarity motion;

  bool operator<(const Start& other) const {
    return cost != other.cost ? cost < other.cost : order < other.order;
  }
};

class Search {
 public:
  Search(const std::vector<Point>& estimate, const std::vector<Point>& truth, const MayMatch& may_match)
      : estimate_(estimate), truth_(truth), may_match_(may_match) {}

  Similarity Run(const IndexPairs& guess) {
    if (guess.size() >= 2) Add(FitRigid(PairUp(estimate_, truth_, guess)));
    AddPairStarts();
    if (starts_.empty()) AddShifts();
    std::sort(starts_.begin(), starts_.end());
    Start best{std::numeric_limits<double>::infinity(), 0, {}};
    for (std::size_t i = 0; i < std::min(kImproved, starts_.size()); ++i) {
      const Start improved = Improve(starts_[i].motion);
      if (improved.cost < best.cost) best = improved;
    }
    return best.motion;
  }

 private:
  // Sum of capped squared distances to the nearest true point: a lower bound of the one-to-one cost, and
  // quick.
  double NearestCost(const Similarity& motion) const {
    double cost = 0;
    for (std::size_t e = 0; e < estimate_.size(); ++e) {
      const Point at = motion(estimate_[e]);
      double nearest = kCutOffM * kCutOffM;
      for (std::size_t t = 0; t < truth_.size(); ++t) {
        const double dx = at.x_m - truth_[t].x_m, dy = at.y_m - truth_[t].y_m;
        const double square = dx * dx + dy * dy;
        if (square < nearest && may_match_(e, t)) nearest = square;
      }
      cost += nearest;
    }
    return cost;
  }

  void Add(const Similarity& motion) {
    starts_.push_back({NearestCost(motion), found_++, motion});
    if (starts_.size() < 4 * kImproved) return;
    std::sort(starts_.begin(), starts_.end());
    starts_.resize(kImproved);
  }

  static IndexPairs Baselines(const std::vector<Point>& points, bool both_ways) {
    IndexPairs pairs;
    for (std::size_t i = 0; i < points.size(); ++i) {
      for (std::size_t j = both_ways ? 0 : i + 1; j < points.size(); ++j) {
        if (i != j && DistanceM(points[i], points[j]) >= kMinBaselineM) pairs.emplace_back(i, j);
      }
    }
    return pairs;
  }

  void AddPairStarts() {
    const IndexPairs ours = Baselines(estimate_, false), theirs = Baselines(truth_, true);
    const std::size_t stride = std::max<std::size_t>(1, ours.size() * theirs.size() / kMaxStarts);
    for (std::size_t a = 0; a < ours.size(); a += stride) {
      const auto [i, j] = ours[a];
      const double length = DistanceM(estimate_[i], estimate_[j]);
      for (const auto& [k, l] : theirs) {
        if (std::abs(DistanceM(truth_[k], truth_[l]) - length) > kLengthToleranceM) continue;
        if (!may_match_(i, k) || !may_match_(j, l)) continue;
        Add(FitRigid({{estimate_[i], truth_[k]}, {estimate_[j], truth_[l]}}));
      }
    }
  }

  void AddShifts() {
    for (std::size_t e = 0; e < estimate_.size(); ++e) {
      for (std::size_t t = 0; t < truth_.size(); ++t) {
        if (may_match_(e, t)) Add(FitRigid({{estimate_[e], truth_[t]}}));
      }
    }
  }

  Start Improve(Similarity motion) const {
    PointMatch match = MatchMoved(motion);
    for (int round = 0; round < kMaxRounds && !match.pairs.empty(); ++round) {
      const Similarity fit = FitRigid(PairUp(estimate_, truth_, match.pairs));
      PointMatch next = MatchMoved(fit);
      if (next.gospa_m > match.gospa_m) break;
      motion = fit;
      const bool settled = next.pairs == match.pairs;
      match = std::move(next);
      if (settled) break;
    }
    return {match.gospa_m, 0, motion};
  }

  PointMatch MatchMoved(const Similarity& motion) const {
    std::vector<Point> moved;
    moved.reserve(estimate_.size());
    for (const Point& point : estimate_) moved.push_back(motion(point));
    return MatchPoints(moved, truth_, may_match_);
  }

  const std::vector<Point>& estimate_;
  const std::vector<Point>& truth_;
  const MayMatch& may_match_;
  std::vector<Start> starts_;
  std::size_t found_ = 0;
};

}  // namespace

std::vector<PointPair> PairUp(const std::vector<Point>& estimate, const std::vector<Point>& truth,
                              const IndexPairs& pairs) {
  std::vector<PointPair> points;
  for (const auto& [e, t] : pairs) points.push_back({estimate[e], truth[t]});
  return points;
}

Similarity SearchRigid(const std::vector<Point>& estimate, const std::vector<Point>& truth,
                       const MayMatch& may_match, const IndexPairs& guess) {
  return Search(estimate, truth, may_match).Run(guess);
}

}  // namespace cairn::datasets
