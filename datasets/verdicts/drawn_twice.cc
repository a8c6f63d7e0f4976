#include "datasets/verdicts/drawn_twice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

#include "schema/geometry.h"

namespace cairn::datasets {
namespace {

constexpr double kOneDegree = std::numbers::pi / 180;

std::string ApartText(double way_m, double turn_rad) {
  constexpr double kWay_m = 0.1, kTurn_rad = 2 * kOneDegree;
  const std::string way = fmt::format("{:.1f} m", way_m),
                    turn = fmt::format("{} degrees", std::lround(turn_rad / kOneDegree));
  if (way_m < kWay_m) return turn;
  return turn_rad < kTurn_rad ? way : way + " and " + turn;
}

// Where two lasers of a robot see the same walls in different places, each wall stands twice in the map. What
// only one of them sees, as the legs of a table, is no mount's fault: another one would explain it no better.
Verdict::Doubt OfLasers(const kinds::LocalMap::Lasers& lasers, std::size_t i) {
  constexpr std::int64_t kFew = 500;  // of 4000: they look elsewhere
  constexpr double kAgree = 0.9, kExplains = 0.85, kSeldom = 0.3, kLess = 0.5, kMore = 1.25, kMoved_m = 0.1,
                   kMoved_rad = 4 * kOneDegree;
  const auto looked = static_cast<double>(lasers.looked[i]),
             moved_looked = static_cast<double>(lasers.moved_looked[i]);
  const double share = lasers.share[i], moved_share = lasers.moved_share[i];
  const bool better = moved_share > kExplains &&
                      (1 - moved_share) * moved_looked < kLess * (1 - share) * looked &&
                      moved_share * moved_looked > kMore * share * looked;
  const bool moved = lasers.moved_m[i] > kMoved_m || lasers.moved_rad[i] > kMoved_rad;
  const bool seldom = lasers.looked[i] < kFew || looked < kSeldom * moved_looked;
  if (seldom || share > kAgree || !better || !moved) return {Confidence::kHigh};
  return {
      Confidence::kLow,
      fmt::format("'{}' and '{}' see walls in different places, about {} apart: {:.0f}% of what the second "
                  "meets stands where the first met something, and {:.0f}% would if one of them sat "
                  "elsewhere. Is a mount wrong? Cairn has it from the log, of a bag from tf or `--mount`",
                  lasers.first[i], lasers.second[i], ApartText(lasers.moved_m[i], lasers.moved_rad[i]),
                  100 * share, 100 * moved_share)};
}

// Scans of different passes of a place of which one hit what the other looked through, and that meet when one
// of them lies elsewhere.
struct Doubled {
  std::size_t passes = 0, doubled = 0;
  double apart_m = 0;  // nine tenths of them by no more
  Point around;        // where most of them are
  double Share() const { return passes > 0 ? static_cast<double>(doubled) / static_cast<double>(passes) : 0; }
};

Doubled FindDoubled(const kinds::LocalMap::Robot& robot) {
  constexpr double kMost = 0.9, kAround_m = 3;
  Doubled all;
  all.passes = robot.passes.doubled.OrNone().size();
  std::vector<double> apart_m;
  std::vector<Point> at;
  const auto time_s = robot.poses.time_s.OrNone();
  for (std::size_t i = 0; i < all.passes; ++i) {
    if (robot.passes.doubled[i] == 0) continue;
    apart_m.push_back(std::hypot(robot.passes.off_x_m[i], robot.passes.off_y_m[i]));
    const auto scan =
        static_cast<std::size_t>(std::ranges::lower_bound(time_s, robot.passes.from_s[i]) - time_s.begin());
    if (scan < time_s.size()) at.push_back({robot.poses.x_m[scan], robot.poses.y_m[scan]});
  }
  all.doubled = apart_m.size();
  if (all.doubled == 0) return all;
  std::ranges::sort(apart_m);
  all.apart_m = apart_m[static_cast<std::size_t>(kMost * static_cast<double>(all.doubled - 1))];
  std::ptrdiff_t most = 0;
  for (const Point& p : at) {
    const std::ptrdiff_t near = std::ranges::count_if(
        at, [&](const Point& q) { return std::hypot(q.x_m - p.x_m, q.y_m - p.y_m) < kAround_m; });
    if (near <= most) continue;
    most = near;
    all.around = p;
  }
  return all;
}

}  // namespace

void JudgeLasers(const kinds::LocalMap& map, Verdict* verdict) {
  for (const kinds::LocalMap::Robot& robot : map.robot) {
    for (std::size_t i = 0; i < robot.lasers.looked.OrNone().size(); ++i) {
      verdict->numbers.emplace_back("lasers_agree", robot.lasers.share[i]);
      verdict->Add(OfLasers(robot.lasers, i));
    }
  }
}

void JudgePasses(const kinds::LocalMap& map, Verdict* verdict) {
  constexpr double kLow = 0.14, kFair = 0.07;
  constexpr std::size_t kLeast = 20;  // so few are chance
  for (const kinds::LocalMap::Robot& robot : map.robot) {
    const Doubled doubled = FindDoubled(robot);
    if (doubled.passes == 0) continue;
    verdict->AddCount("passes", doubled.passes);
    verdict->AddCount("passes_doubled", doubled.doubled);
    if (doubled.doubled < kLeast || doubled.Share() < kFair) continue;
    const bool many = doubled.Share() >= kLow;
    verdict->Add(
        {many ? Confidence::kLow : Confidence::kFair,
         fmt::format("{} drawn twice, up to {:.1f} m apart, most around x {:.0f}, y {:.0f} m: {:.0f}% "
                     "of the scans see through walls that those of another pass hit there",
                     many ? "the same places are" : "some places are", doubled.apart_m, doubled.around.x_m,
                     doubled.around.y_m, 100 * doubled.Share())});
  }
}

}  // namespace cairn::datasets
