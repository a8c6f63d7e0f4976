#include "pipelines/landmark_map/refinement/placing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <tuple>

#include "schema/square.h"

namespace cairn::landmark_map {
namespace {

constexpr double kGatePlacing = 3;        // standard deviations
constexpr double kMostAgainst = 3;        // nats of a landmark that is not seen
constexpr double kAgainstALook = 0.5;     // nats of each time that it should have been
constexpr double kSpeaksAgainst = 1.5;    // nats from which on it is counted
constexpr std::size_t kMostLooks = 400;   // of a robot
constexpr std::size_t kMostLaid = 40;     // landmarks of either side
constexpr std::size_t kMostFitted = 200;  // placings

double QuantileOf(std::vector<double> values, double share) {
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, values.begin() + at);
  return values[static_cast<std::size_t>(at)];
}

Submap::View ViewOf(std::span<const PlacedRow> rows) {
  constexpr double kFarthest = 0.95, kOutermost = 0.02;
  std::vector<double> ranges, bearings;
  double sine = 0, cosine = 0;
  for (const PlacedRow& row : rows) {
    ranges.push_back(row.range_m);
    sine += std::sin(row.bearing_rad);
    cosine += std::cos(row.bearing_rad);
  }
  const double middle = std::atan2(sine, cosine);
  for (const PlacedRow& row : rows) bearings.push_back(WrapAngle(row.bearing_rad - middle));
  return {QuantileOf(ranges, kFarthest), middle, QuantileOf(bearings, kOutermost),
          QuantileOf(bearings, 1 - kOutermost)};
}

void AddLooks(std::span<const PlacedRow> rows, Submap* submap) {
  std::vector<Pose> from;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (i == 0 || rows[i].time_s != rows[i - 1].time_s) from.push_back(rows[i].from);
  const std::size_t every = (from.size() + kMostLooks - 1) / kMostLooks;
  for (std::size_t i = 0; i < from.size(); i += every)
    submap->looks.push_back({from[i], submap->views.size()});
  submap->views.push_back(ViewOf(rows));
}

// What it says against a landmark there that the submap does not have it.
double Against(const Submap& submap, Point at) {
  return std::min(kMostAgainst, kAgainstALook * submap.detected * submap.LooksAt(at));
}

Point PointOf(const Submap::Seen& seen) { return {seen.x_m, seen.y_m}; }
Point Moved(const Pose& at, Point point) {
  const Pose moved = Compose(at, {point.x_m, point.y_m, 0});
  return {moved.x_m, moved.y_m};
}

// The area in which landmarks lie, the larger one's, and how far from the middle those of `one` do.
struct Extent {
  double area_m2, radius_m;
};

Extent ExtentOf(const Submap& one, const Submap& base) {
  Extent extent{0, 0};
  for (const Submap* submap : {&base, &one}) {
    Point low{1e300, 1e300}, high{-1e300, -1e300};
    double reach_m = 0;
    for (const Submap::View& view : submap->views) reach_m = std::max(reach_m, view.reach_m);
    for (const Submap::Seen& seen : submap->landmarks) {
      low = {std::min(low.x_m, seen.x_m), std::min(low.y_m, seen.y_m)};
      high = {std::max(high.x_m, seen.x_m), std::max(high.y_m, seen.y_m)};
    }
    extent.area_m2 = std::max(extent.area_m2,
                              std::max(high.x_m - low.x_m, reach_m) * std::max(high.y_m - low.y_m, reach_m));
    extent.radius_m = DistanceM(low, high) / 2;
  }
  return extent;
}

// The sides of the box in which a submap lies; no less than it sees far.
Point SidesOf(const Submap& submap) {
  Point low{1e300, 1e300}, high{-1e300, -1e300};
  double reach_m = 0;
  for (const Submap::View& view : submap.views) reach_m = std::max(reach_m, view.reach_m);
  for (const Submap::Seen& seen : submap.landmarks) {
    low = {std::min(low.x_m, seen.x_m), std::min(low.y_m, seen.y_m)};
    high = {std::max(high.x_m, seen.x_m), std::max(high.y_m, seen.y_m)};
  }
  return {std::max(high.x_m - low.x_m, reach_m), std::max(high.y_m - low.y_m, reach_m)};
}

using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

// Of `one` placed so, each landmark with one of `base` at most, the nearest first.
Pairs PairsAt(const Submap& one, const Submap& base, const Pose& at, double gate_m) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> near;
  for (std::size_t i = 0; i < one.landmarks.size(); ++i) {
    const Point moved = Moved(at, PointOf(one.landmarks[i]));
    for (std::size_t j = 0; j < base.landmarks.size(); ++j) {
      const double apart_m = DistanceM(moved, PointOf(base.landmarks[j]));
      if (apart_m <= gate_m) near.emplace_back(apart_m, i, j);
    }
  }
  std::ranges::sort(near);
  std::vector<bool> taken(one.landmarks.size(), false), given(base.landmarks.size(), false);
  Pairs pairs;
  for (const auto& [apart_m, i, j] : near) {
    if (taken[i] || given[j]) continue;
    taken[i] = given[j] = true;
    pairs.emplace_back(i, j);
  }
  return pairs;
}

// The ratio's logarithm but for what speaks against it. Of a landmark in common: the Gaussian of where the
// one sees it from the other over the density of landmarks, which lays another one there. Of the place: the
// part that the Gaussian about it has of all places and headings.
double OddsOf(const Submap& one, const Submap& base, const Pairs& pairs, double apart_m2, double sigma_m) {
  const double variance = sigma_m * sigma_m, circle = 2 * std::numbers::pi;
  const auto n = static_cast<double>(pairs.size());
  const Point sides = SidesOf(one), of_base = SidesOf(base);
  const double density = std::max(static_cast<double>(one.landmarks.size()) / (sides.x_m * sides.y_m),
                                  static_cast<double>(base.landmarks.size()) / (of_base.x_m * of_base.y_m));
  Point middle{0, 0};
  for (const auto& [i, j] : pairs)
    middle = {middle.x_m + one.landmarks[i].x_m / n, middle.y_m + one.landmarks[i].y_m / n};
  double spread_m2 = 0;
  for (const auto& [i, j] : pairs) spread_m2 += Square(DistanceM(PointOf(one.landmarks[i]), middle));
  if (!(spread_m2 > 0)) return -std::numeric_limits<double>::infinity();  // any heading will do
  const double all = (sides.x_m + of_base.x_m) * (sides.y_m + of_base.y_m) * circle;
  const double part = circle * variance / n * std::sqrt(circle * variance / spread_m2);
  return -n * std::log(circle * variance * density) - apart_m2 / (2 * variance) -
         std::log(std::max(1.0, all / part));
}

Placing Weigh(const Submap& one, const Submap& base, const Pose& at, double sigma_m) {
  const Extent extent = ExtentOf(one, base);
  const double variance = sigma_m * sigma_m, circle = 2 * std::numbers::pi;
  const double by_chance = std::log(std::max(1.0, extent.area_m2 / (circle * variance)));
  Placing placing{at, 0, 0, 0, PairsAt(one, base, at, kGatePlacing * sigma_m)};
  // Its place and its heading.
  placing.nats = -by_chance - std::log(std::max(1.0, circle * extent.radius_m / sigma_m));
  std::vector<bool> taken(one.landmarks.size(), false), given(base.landmarks.size(), false);
  double apart_m2 = 0;
  for (const auto& [i, j] : placing.pairs) {
    taken[i] = given[j] = true;
    const double apart_m = DistanceM(Moved(at, PointOf(one.landmarks[i])), PointOf(base.landmarks[j]));
    placing.nats += by_chance - apart_m * apart_m / (2 * variance);
    apart_m2 += apart_m * apart_m;
  }
  placing.odds_nats = OddsOf(one, base, placing.pairs, apart_m2, sigma_m);
  const Pose back = Between(at, Pose{});
  const auto speaks = [&](double against) {
    placing.nats -= against;
    placing.odds_nats -= against;
    placing.contradicted += against >= kSpeaksAgainst ? 1 : 0;
  };
  for (std::size_t i = 0; i < taken.size(); ++i)
    if (!taken[i]) speaks(Against(base, Moved(at, PointOf(one.landmarks[i]))));
  for (std::size_t j = 0; j < given.size(); ++j)
    if (!given[j]) speaks(Against(one, Moved(back, PointOf(base.landmarks[j]))));
  return placing;
}

// That which lays the pairs on one another with the least squares of what is left.
Pose FitTo(const Submap& one, const Submap& base, const Pairs& pairs) {
  const auto n = static_cast<double>(pairs.size());
  Point from{0, 0}, to{0, 0};
  for (const auto& [i, j] : pairs) {
    from = {from.x_m + one.landmarks[i].x_m / n, from.y_m + one.landmarks[i].y_m / n};
    to = {to.x_m + base.landmarks[j].x_m / n, to.y_m + base.landmarks[j].y_m / n};
  }
  double sine = 0, cosine = 0;
  for (const auto& [i, j] : pairs) {
    const double ax = one.landmarks[i].x_m - from.x_m, ay = one.landmarks[i].y_m - from.y_m;
    const double bx = base.landmarks[j].x_m - to.x_m, by = base.landmarks[j].y_m - to.y_m;
    sine += ax * by - ay * bx;
    cosine += ax * bx + ay * by;
  }
  const Pose turn{0, 0, std::atan2(sine, cosine)};
  const Point turned = Moved(turn, from);
  return {to.x_m - turned.x_m, to.y_m - turned.y_m, turn.heading_rad};
}

Submap MostSeen(const Submap& submap) {
  Submap most;
  most.landmarks = submap.landmarks;
  std::ranges::stable_sort(most.landmarks, std::ranges::greater{}, &Submap::Seen::count);
  if (most.landmarks.size() > kMostLaid) most.landmarks.resize(kMostLaid);
  return most;
}

std::size_t CountNear(const Submap& one, const Submap& base, const Pose& at, double gate_m) {
  std::size_t near = 0;
  for (const Submap::Seen& seen : one.landmarks) {
    const Point moved = Moved(at, PointOf(seen));
    near += std::ranges::any_of(base.landmarks, [&](const Submap::Seen& other) {
      return std::abs(moved.x_m - other.x_m) <= gate_m && std::abs(moved.y_m - other.y_m) <= gate_m &&
             DistanceM(moved, PointOf(other)) <= gate_m;
    });
  }
  return near;
}

// Those that lay a pair of landmarks on another as long, by how many landmarks are then near one: the best.
std::vector<Pose> Laid(const Submap& all_one, const Submap& all_base, double sigma_m) {
  const Submap one = MostSeen(all_one), base = MostSeen(all_base);
  const double shortest_m = 4 * sigma_m, differ_m = 2 * sigma_m;
  struct Lies {
    std::size_t near;
    Pose at;
  };
  std::vector<Lies> all;
  const auto length = [](const Submap& in, std::size_t a, std::size_t b) {
    return DistanceM(PointOf(in.landmarks[a]), PointOf(in.landmarks[b]));
  };
  for (std::size_t i = 0; i < one.landmarks.size(); ++i) {
    for (std::size_t k = i + 1; k < one.landmarks.size(); ++k) {
      const double length_m = length(one, i, k);
      if (length_m < shortest_m) continue;
      for (std::size_t j = 0; j < base.landmarks.size(); ++j) {
        for (std::size_t l = 0; l < base.landmarks.size(); ++l) {
          if (l == j || std::abs(length(base, j, l) - length_m) > differ_m) continue;
          const Pose at = FitTo(one, base, {{i, j}, {k, l}});
          all.push_back({CountNear(one, base, at, kGatePlacing * sigma_m), at});
        }
      }
    }
    // Of a great many only the best are kept.
    if (all.size() < 100 * kMostFitted && i + 1 < one.landmarks.size()) continue;
    std::ranges::stable_sort(all, std::ranges::greater{}, &Lies::near);
    if (all.size() > kMostFitted) all.resize(kMostFitted);
  }
  std::vector<Pose> best;
  for (const Lies& lies : all) best.push_back(lies.at);
  return best;
}

}  // namespace

double Submap::LooksAt(Point at) const {
  double count = 0;
  for (const Look& look : looks) {
    const View& view = views[look.view];
    const double dx = at.x_m - look.from.x_m, dy = at.y_m - look.from.y_m;
    if (dx * dx + dy * dy > view.reach_m * view.reach_m) continue;
    const double bearing = WrapAngle(std::atan2(dy, dx) - look.from.heading_rad - view.middle_rad);
    count += bearing >= view.right_rad && bearing <= view.left_rad ? 1 : 0;
  }
  return count;
}

Submap SubmapOf(const std::vector<std::span<const PlacedRow>>& rows) {
  constexpr std::int64_t kLeast = 2;
  Submap submap;
  std::map<std::int32_t, Submap::Seen> sums;
  double seen = 0, looks = 0;
  for (const std::span<const PlacedRow> robot : rows) {
    if (robot.empty()) continue;
    AddLooks(robot, &submap);
    for (const PlacedRow& row : robot) {
      if (row.landmark < 0) continue;
      Submap::Seen& sum =
          sums.try_emplace(row.landmark, Submap::Seen{0, 0, row.landmark, 0, false}).first->second;
      sum.told |= row.told;
      const double ray = row.from.heading_rad + row.bearing_rad;
      sum.x_m += row.from.x_m + row.range_m * std::cos(ray);
      sum.y_m += row.from.y_m + row.range_m * std::sin(ray);
      ++sum.count;
    }
  }
  for (const auto& [landmark, sum] : sums) {
    if (sum.count < kLeast) continue;
    const auto count = static_cast<double>(sum.count);
    submap.landmarks.push_back({sum.x_m / count, sum.y_m / count, landmark, sum.count, sum.told});
  }
  double images = 0;
  for (const std::span<const PlacedRow> robot : rows)
    for (std::size_t i = 0; i < robot.size(); ++i)
      images += i == 0 || robot[i].time_s != robot[i - 1].time_s ? 1 : 0;
  for (const Submap::Seen& landmark : submap.landmarks) {
    seen += static_cast<double>(landmark.count);
    looks += submap.LooksAt(PointOf(landmark));
  }
  const double of_all = images > 0 ? static_cast<double>(submap.looks.size()) / images : 1;
  submap.images_a_look = 1 / of_all;
  submap.detected = looks > 0 ? std::min(1.0, seen * of_all / looks) : 1;
  return submap;
}

Placing PlacingHere(const Submap& one, const Submap& base, double sigma_m) {
  if (one.landmarks.empty() || base.landmarks.empty()) return {{}, 0, 0, 0, {}};
  return Weigh(one, base, Pose{}, sigma_m);
}

Placings FindPlacings(const Submap& one, const Submap& base, double sigma_m) {
  constexpr int kFits = 2;
  Placings found{PlacingHere(one, base, sigma_m), std::nullopt};
  if (one.landmarks.empty() || base.landmarks.empty()) return found;
  for (Pose at : Laid(one, base, sigma_m)) {
    for (int fit = 0; fit < kFits; ++fit) {
      const Pairs pairs = PairsAt(one, base, at, kGatePlacing * sigma_m);
      if (pairs.size() < 2) break;
      at = FitTo(one, base, pairs);
    }
    Placing placing = Weigh(one, base, at, sigma_m);
    const auto as_here = std::ranges::count_if(placing.pairs, [&](const auto& pair) {
      return std::ranges::find(found.here.pairs, pair) != found.here.pairs.end();
    });
    if (2 * static_cast<std::size_t>(as_here) > found.here.pairs.size()) continue;
    if (!found.other || placing.nats > found.other->nats) found.other = std::move(placing);
  }
  return found;
}

}  // namespace cairn::landmark_map
