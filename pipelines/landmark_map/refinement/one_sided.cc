#include "pipelines/landmark_map/refinement/one_sided.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "schema/geometry.h"

namespace cairn::landmark_map {
namespace {

constexpr std::size_t kMostImages = 1000;  // of a robot, evenly
constexpr int kOften = 3;

double OrderStatistic(std::vector<double> values, double share) {
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, values.begin() + at);
  return values[static_cast<std::size_t>(at)];
}

// Where the robot's sensor sees well: not to the edges of its view.
class WellInView {
 public:
  explicit WellInView(std::span<const Sighting> seen) {
    constexpr double kOfRanges = 0.9, kOutermost = 0.05;
    double sine = 0, cosine = 0;
    for (const Sighting& of : seen) {
      sine += std::sin(std::atan2(of.y_m, of.x_m));
      cosine += std::cos(std::atan2(of.y_m, of.x_m));
    }
    middle_rad_ = std::atan2(sine, cosine);
    std::vector<double> ranges, bearings;
    for (const Sighting& of : seen) {
      ranges.push_back(std::hypot(of.x_m, of.y_m));
      bearings.push_back(WrapAngle(std::atan2(of.y_m, of.x_m) - middle_rad_));
    }
    reach_m_ = OrderStatistic(ranges, kOfRanges);
    right_rad_ = OrderStatistic(bearings, kOutermost);
    left_rad_ = OrderStatistic(bearings, 1 - kOutermost);
  }

  bool Holds(const Eigen::Vector3d& from, const Eigen::Vector2d& place) const {
    const double dx = place.x() - from.x(), dy = place.y() - from.y();
    if (dx * dx + dy * dy > reach_m_ * reach_m_) return false;
    const double bearing = WrapAngle(std::atan2(dy, dx) - from.z() - middle_rad_);
    return bearing >= right_rad_ && bearing <= left_rad_;
  }

 private:
  double reach_m_, middle_rad_, right_rad_, left_rad_;
};

// Of one landmark, up to each image [images + 1].
struct Counts {
  std::vector<int> looks, shown;  // images that have it well in view; those of them that show it
  std::vector<int> seen;          // all its sightings
};

// One robot's sightings at a distance, in the order of nodes.
class Sides {
 public:
  Sides(std::span<const Sighting> seen, const std::vector<Eigen::Vector3d>& nodes) : view_(seen) {
    for (const Sighting& of : seen)
      if (nodes_.empty() || nodes_.back() != of.node) nodes_.push_back(of.node);
    const std::size_t every = (nodes_.size() + kMostImages - 1) / kMostImages;
    std::vector<int> kept;
    for (std::size_t i = 0; i < nodes_.size(); i += every) kept.push_back(nodes_[i]);
    nodes_ = std::move(kept);
    for (const int node : nodes_) poses_.push_back(nodes[static_cast<std::size_t>(node)]);
    balance_.resize(nodes_.size());
  }

  // `seen`: the landmark's alone.
  void Add(std::span<const Sighting> seen, const Eigen::Vector2d& place) {
    const Counts counts = CountsOf(seen, place);
    const std::size_t images = nodes_.size();
    for (std::size_t at = images / 10; at + images / 10 < images; ++at) {
      const int before = counts.seen[at + 1], after = counts.seen[images] - before;
      const int looks = counts.looks[at + 1], later = counts.looks[images] - looks;
      const int shown = counts.shown[at + 1], shown_later = counts.shown[images] - shown;
      OneSided& here = balance_[at];
      if (before > 0 && after > 0) {
        here.two_sided += Expected(shown + shown_later, looks + later, std::min(looks, later));
      } else if (after == 0) {
        here.one_sided += Expected(shown, looks, later);
      } else {
        here.one_sided += Expected(shown_later, later, looks);
      }
    }
  }

  // The moments in nodes.
  OneSided Worst() const {
    OneSided worst;
    for (std::size_t at = 0; at < balance_.size(); ++at) {
      const std::int64_t one_sided = balance_[at].one_sided;
      if (one_sided > worst.most) {
        worst.most = one_sided;
        worst.most_at_s = nodes_[at];
      }
      if (balance_[at].Excess() <= worst.Excess()) continue;
      worst.one_sided = one_sided;
      worst.two_sided = balance_[at].two_sided;
      worst.at_s = nodes_[at];
    }
    return worst;
  }

 private:
  // Whether what was shown so often in so many looks would be, often enough, in those of the other side.
  static bool Expected(int shown, int looks, int there) {
    return shown >= kOften && kOften * looks <= static_cast<double>(shown) * there;
  }

  Counts CountsOf(std::span<const Sighting> seen, const Eigen::Vector2d& place) const {
    Counts counts{{0}, {0}, {0}};
    auto next = seen.begin();
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      int sightings = 0;
      bool shows = false;
      for (; next != seen.end() && next->node <= nodes_[i]; ++next) {
        ++sightings;
        shows |= next->node == nodes_[i];
      }
      const bool looks = view_.Holds(poses_[i], place);
      counts.looks.push_back(counts.looks.back() + looks);
      counts.shown.push_back(counts.shown.back() + (looks && shows));
      counts.seen.push_back(counts.seen.back() + sightings);
    }
    counts.seen.back() += static_cast<int>(seen.end() - next);
    return counts;
  }

  WellInView view_;
  std::vector<int> nodes_;
  std::vector<Eigen::Vector3d> poses_;
  std::vector<OneSided> balance_;  // [images]: between each and the next
};

}  // namespace

OneSided FindOneSided(const LeastSquaresProblem& problem, const LeastSquaresPoint& point) {
  OneSided worst;
  for (std::size_t r = 0; r < problem.robots.size(); ++r) {
    std::vector<Sighting> seen;
    for (const Sighting& of : problem.sightings)
      if (of.robot == static_cast<int>(r) && !of.contact()) seen.push_back(of);
    if (seen.empty()) continue;
    Sides sides(seen, point.nodes[r]);
    std::ranges::stable_sort(seen, {}, &Sighting::landmark);
    for (auto begin = seen.begin(); begin != seen.end();) {
      const auto end = std::ranges::upper_bound(begin, seen.end(), begin->landmark, {}, &Sighting::landmark);
      sides.Add({begin, end}, point.landmarks[static_cast<std::size_t>(begin->landmark)]);
      begin = end;
    }
    const OneSided of_robot = sides.Worst();
    const auto time_s = [&](double node) { return problem.robots[r].time_s[static_cast<std::size_t>(node)]; };
    if (of_robot.most > worst.most) {
      worst.most = of_robot.most;
      worst.most_at_s = time_s(of_robot.most_at_s);
    }
    if (of_robot.Excess() <= worst.Excess()) continue;
    worst.one_sided = of_robot.one_sided;
    worst.two_sided = of_robot.two_sided;
    worst.at_s = time_s(of_robot.at_s);
  }
  return worst;
}

}  // namespace cairn::landmark_map
