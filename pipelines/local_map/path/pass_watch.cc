#include "pipelines/local_map/path/pass_watch.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <utility>

#include "pipelines/local_map/path/lost_beams.h"
#include "schema/error.h"

namespace cairn::local_map {
namespace {

constexpr double kTaken_m = 0.5;                       // travelled between two scans that are taken
constexpr double kPassNear_m = 3, kPassBetween_m = 6;  // two passes of a place
constexpr std::size_t kPasses = 12;                    // that a scan is compared with, the nearest
constexpr std::size_t kPassHits = 60;
constexpr double kPassReach_m = 6;  // further away a wrong heading moves hits too far
constexpr int kAside = 6;           // half degrees to either side: walls at a slant
constexpr int kPassTells = 20;      // hits in directions in which the other scan looked, at least

constexpr double kThrough_m = 0.4, kThroughRatio = 0.08;  // that a hit lies before what was seen, and a metre
constexpr double kPassMeets_m = 0.2, kPassMeetsRatio = 0.03;  // of what was seen it is one, likewise
constexpr double kContradicts = 0.25, kPassMeets = 0.7, kPassGain = 0.3;  // shares of hits
constexpr int kElsewhereSteps =
    10;  // steps to each side in which it is looked for elsewhere, then half of one
constexpr double kElsewhereStep_m = 0.3;
constexpr double kFarther = 0.01;  // of the hits, that a metre further must gain

// 0: it hit nothing.
double RangeM(const LaserView& seen, std::size_t beam) {
  const Point& hit = seen.hits[beam];
  return std::isnan(hit.x_m) ? 0 : std::hypot(hit.x_m - seen.origin.x_m, hit.y_m - seen.origin.y_m);
}

// Some of those that lie near.
std::vector<Point> HitsOf(const LaserView& seen) {
  std::vector<Point> near, some;
  for (std::size_t b = 0; b < seen.hits.size(); ++b)
    if (RangeM(seen, b) > 0 && RangeM(seen, b) <= kPassReach_m) near.push_back(seen.hits[b]);
  for (std::size_t k = 0; k < near.size(); ++k)
    if (near.size() <= kPassHits || k * kPassHits / near.size() != (k + 1) * kPassHits / near.size())
      some.push_back(near[k]);
  return some;
}

// Hits of a scan by what another saw in their directions.
struct PassWeighed {
  int looked = 0, through = 0, meets = 0;
  double Through() const { return looked > 0 ? static_cast<double>(through) / looked : 0; }
  double Meets() const { return static_cast<double>(meets) / std::max(looked, kPassTells); }
};

PassWeighed WeighPass(const PassView& from, const std::vector<Point>& hits, const Point& off) {
  PassWeighed weighed;
  for (const Point& hit : hits) {
    const double dx = hit.x_m + off.x_m, dy = hit.y_m + off.y_m;
    const std::size_t direction = DirectionOf(std::atan2(dy, dx));
    const double low_m = from.low_m[direction], high_m = from.high_m[direction];
    if (low_m <= 0) continue;
    const double range_m = std::sqrt(dx * dx + dy * dy), near_m = kPassMeets_m + kPassMeetsRatio * range_m;
    ++weighed.looked;
    weighed.through += range_m < low_m - kThrough_m - kThroughRatio * range_m;
    weighed.meets += range_m >= low_m - near_m && range_m <= high_m + near_m;
  }
  return weighed;
}

// From the origin of the other's beams, in its robot's frame.
std::vector<Point> HitsFrom(const PassView& from, const PassView& to) {
  const Pose moved = Between(from.pose, to.pose);
  std::vector<Point> hits;
  for (const Point& hit : to.hits) {
    const Pose at = Compose(moved, {hit.x_m, hit.y_m, 0});
    hits.push_back({at.x_m - from.origin.x_m, at.y_m - from.origin.y_m});
  }
  return hits;
}

// Where else the hits meet what the other saw best.
struct Elsewhere {
  Point off;
  double meets = -1, worth = -1;
  void Try(const PassView& from, const std::vector<Point>& hits, const Point& at) {
    const double share = WeighPass(from, hits, at).Meets();
    const double is_worth = share - kFarther * std::hypot(at.x_m, at.y_m);
    if (is_worth > worth) *this = {at, share, is_worth};
  }
};

Elsewhere BestElsewhere(const PassView& from, const std::vector<Point>& hits) {
  Elsewhere best;
  for (int x = -kElsewhereSteps; x <= kElsewhereSteps; ++x)
    for (int y = -kElsewhereSteps; y <= kElsewhereSteps; ++y)
      best.Try(from, hits, {x * kElsewhereStep_m, y * kElsewhereStep_m});
  const Point coarse = best.off;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      best.Try(from, hits, {coarse.x_m + x * kElsewhereStep_m / 2, coarse.y_m + y * kElsewhereStep_m / 2});
  return best;
}

// Of each pass by `view` the scan that lies nearest, the nearest of these first.
std::vector<std::size_t> PassesBy(const PassView& view, const std::vector<PassView>& taken) {
  struct Near {
    std::size_t at;
    double off_m;
  };
  std::vector<Near> passes;
  bool goes_on = false;
  for (std::size_t k = 0; k < taken.size(); ++k) {
    const double off_m = std::hypot(taken[k].pose.x_m - view.pose.x_m, taken[k].pose.y_m - view.pose.y_m);
    if (off_m > kPassNear_m || std::abs(taken[k].path_m - view.path_m) < kPassBetween_m) {
      goes_on = false;
      continue;
    }
    if (!goes_on)
      passes.push_back({k, off_m});
    else if (off_m < passes.back().off_m)
      passes.back() = {k, off_m};
    goes_on = true;
  }
  std::ranges::stable_sort(passes, {}, &Near::off_m);
  std::vector<std::size_t> nearest;
  for (const Near& near : passes)
    if (nearest.size() < kPasses) nearest.push_back(near.at);
  return nearest;
}

}  // namespace

std::vector<LoopConstraint> MakePassConstraints(const std::vector<Passing>& passes, std::size_t robot,
                                                const std::vector<PathNode>& nodes) {
  constexpr double kSd_m = 0.15;
  const auto node_of = [&](std::int64_t scan) {
    const std::pair wanted(robot, static_cast<std::size_t>(scan));
    const auto next = std::ranges::upper_bound(
        nodes, wanted, {}, [](const PathNode& node) { return std::pair(node.robot, node.scan); });
    if (next == nodes.begin() || std::prev(next)->robot != robot)
      throw InputError("a pass is of a scan before the path's first node");
    return static_cast<std::size_t>(std::prev(next) - nodes.begin());
  };
  std::vector<LoopConstraint> constraints;
  for (const Passing& passing : passes) {
    if (!passing.doubled) continue;
    const std::size_t from = node_of(passing.from), to = node_of(passing.to);
    constraints.push_back({.from = static_cast<std::int32_t>(from),
                           .to = static_cast<std::int32_t>(to),
                           .offset = {nodes[to].at.x_m - nodes[from].at.x_m + passing.off.x_m,
                                      nodes[to].at.y_m - nodes[from].at.y_m + passing.off.y_m},
                           .axis_rad = 0,
                           .sd_z_m = kSd_m,
                           .sd_u_m = kSd_m,
                           .quality = 1});
  }
  return constraints;
}

PassWatch::PassWatch(const ScaleWatch::Ring& laser)
    : beams_(laser.beams), fan_(laser.beams, laser.max_range_m) {}

void PassWatch::Add(std::int64_t scan, const Pose& pose, double path_m, const RingScan& read) {
  if (!taken_.empty() && path_m - taken_.back().path_m < kTaken_m) return;
  const LaserView seen = fan_.View(read);
  PassView view{scan, pose, path_m, seen.origin, HitsOf(seen), {}, {}};
  Look(seen, &view);
  taken_.push_back(std::move(view));
}

void PassWatch::Look(const LaserView& seen, PassView* view) const {
  std::vector<bool> answered(seen.hits.size());
  for (std::size_t b = 0; b < answered.size(); ++b) answered[b] = RangeM(seen, b) > 0;
  const std::vector<bool> lost = LostBeams(beams_, answered);
  constexpr int kCircle = static_cast<int>(kDirections);
  for (int d = 0; d < kCircle; ++d) {
    double low = HUGE_VAL, high = 0;
    for (int by = -kAside; by <= kAside; ++by) {
      const std::int16_t beam = seen.beam_at[static_cast<std::size_t>((d + by + kCircle) % kCircle)];
      if (beam >= 0 && lost[static_cast<std::size_t>(beam)]) continue;
      const double range = beam < 0 ? 0 : RangeM(seen, static_cast<std::size_t>(beam));
      low = std::min(low, range);
      high = std::max(high, range);
    }
    view->low_m.push_back(high > 0 ? static_cast<float>(low) : 0);
    view->high_m.push_back(static_cast<float>(high));
  }
}

std::vector<Passing> PassWatch::Compare(Progress& progress) const {
  std::vector<Passing> all;
  for (const PassView& from : taken_) {
    progress.Tick();
    for (const std::size_t k : PassesBy(from, taken_)) {
      const PassView& to = taken_[k];
      const std::vector<Point> hits = HitsFrom(from, to);
      const PassWeighed here = WeighPass(from, hits, {});
      // Most of what lies in the next room is not seen from here.
      if (here.through + here.meets < kPassTells) continue;
      Passing passing{
          .from = from.scan, .to = to.scan, .through = here.Through(), .doubled = false, .off = {}};
      if (passing.through > kContradicts) {
        const Elsewhere best = BestElsewhere(from, hits);
        passing.doubled = best.meets >= kPassMeets && best.meets >= here.Meets() + kPassGain;
        if (passing.doubled) {
          const Pose off = Compose({0, 0, from.pose.heading_rad}, {best.off.x_m, best.off.y_m, 0});
          passing.off = {off.x_m, off.y_m};
        }
      }
      all.push_back(passing);
    }
  }
  return all;
}

}  // namespace cairn::local_map
