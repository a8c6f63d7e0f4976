#include "datasets/common/landmarks_on_one_side.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <vector>

namespace cairn::datasets {
namespace {

// Of one robot's observations that are of a landmark: the number of the first and of the last one of each.
struct Seen {
  std::size_t first = 0, last = 0;
};

struct RobotSeen {
  std::map<std::int32_t, Seen> landmarks;
  std::vector<std::size_t> number;  // of these observations, among all of the robot's, from 1 on
};

std::vector<RobotSeen> SeenIn(const kinds::LandmarkMap& map) {
  std::vector<RobotSeen> robots;
  for (const kinds::LandmarkMap::Robot& robot : map.robot) {
    RobotSeen& seen = robots.emplace_back();
    const auto& landmarks = robot.map_landmark.OrNone();
    for (std::size_t i = 0; i < landmarks.size(); ++i) {
      if (landmarks[i] < 0) continue;
      const std::size_t at = seen.number.size();
      seen.number.push_back(i + 1);
      seen.landmarks.try_emplace(landmarks[i], at, at).first->second.last = at;
    }
  }
  return robots;
}

struct InCommon {
  std::size_t common = 0, of = 0;  // of the landmarks on the side that has fewer
  bool IsLessThan(const InCommon& other) const {
    return other.of == 0 || common * other.of < other.common * of;
  }
};

// What robot r has seen up to its observation `at` and after it; `others`: what each of the others saw.
InCommon InCommonAt(const std::vector<RobotSeen>& robots, std::size_t r, std::size_t at) {
  std::size_t before = 0, after = 0, both = 0;
  std::vector<std::size_t> tied_before(robots.size(), 0), tied_after(robots.size(), 0);
  for (const auto& [landmark, seen] : robots[r].landmarks) {
    const bool is_before = seen.first <= at, is_after = seen.last > at;
    before += is_before;
    after += is_after;
    both += is_before && is_after;
    for (std::size_t other = 0; other < robots.size(); ++other) {
      if (other == r || !robots[other].landmarks.contains(landmark)) continue;
      tied_before[other] += is_before;
      tied_after[other] += is_after;
    }
  }
  for (std::size_t other = 0; other < robots.size(); ++other)
    both = std::max(both, std::min(tied_before[other], tied_after[other]));
  return {both, std::min(before, after)};
}

// Of maps without names that are right there are none.
Verdict::Doubt OfSomeOnOneSide(const kinds::LandmarkMap& map, Verdict* verdict) {
  const std::int64_t some = map.fit.most_one_sided.Or(0);
  if (some == 0) return {Confidence::kHigh};
  verdict->numbers.emplace_back("most_landmarks_on_one_side", static_cast<double>(some));
  return {Confidence::kFair,
          fmt::format("{} landmark{} seen only before or only after {:.1f} s, though the robot looked at {} "
                      "on both sides of it: was something moved, or did odometry slip?",
                      some, some == 1 ? " was" : "s were", map.fit.most_one_sided_s.Or(0),
                      some == 1 ? "its place" : "their places")};
}

}  // namespace

Verdict::Doubt OfLandmarksOnOneSide(const kinds::LandmarkMap& map, Verdict* verdict) {
  constexpr std::int64_t kLeast = 3, kTimes = 2;
  const std::int64_t one_sided = map.fit.one_sided.Or(0), two_sided = map.fit.two_sided.Or(0);
  const auto& identity = map.map.landmark_identity.OrNone();
  const bool nameless = !identity.empty() && std::ranges::all_of(identity, [](int id) { return id < 0; });
  if (!nameless) return {Confidence::kHigh};
  if (one_sided < kLeast || one_sided <= kTimes * two_sided) return OfSomeOnOneSide(map, verdict);
  verdict->numbers.emplace_back("landmarks_on_one_side", static_cast<double>(one_sided));
  verdict->numbers.emplace_back("landmarks_on_both_sides", static_cast<double>(two_sided));
  return {Confidence::kLow,
          fmt::format("{} of {} landmarks were seen only before or only after {:.1f} s, though the robot "
                      "looked at their places on both sides of it: it may have slipped or been carried then, "
                      "and see the same ones twice",
                      one_sided, one_sided + two_sided, map.fit.one_sided_s.Or(0))};
}

Verdict::Doubt OfFewInCommon(const kinds::LandmarkMap& map, Verdict* verdict) {
  constexpr std::size_t kEnds = 10, kLeast = 3;  // a tenth; of fewer landmarks it may be chance
  if (std::ranges::none_of(map.map.landmark_identity.OrNone(), [](int id) { return id < 0; }))
    return {Confidence::kHigh};
  const std::vector<RobotSeen> robots = SeenIn(map);
  InCommon least;
  std::size_t number = 0;
  for (std::size_t r = 0; r < robots.size(); ++r) {
    const std::size_t end = robots[r].number.size() / kEnds;
    std::set<std::size_t> changes = {end};  // between these nothing does
    for (const auto& [landmark, seen] : robots[r].landmarks) changes.insert({seen.first, seen.last});
    for (const std::size_t at : changes) {
      if (at < end || at + 1 + end >= robots[r].number.size()) continue;
      const InCommon here = InCommonAt(robots, r, at);
      if (here.of < kLeast || !here.IsLessThan(least)) continue;
      least = here;
      number = robots[r].number[at];
    }
  }
  if (least.of == 0 || 2 * least.common > least.of) return {Confidence::kHigh};
  verdict->AddCount("fewest_landmarks_in_common", least.common);
  verdict->AddCount("fewest_landmarks_in_common_of", least.of);
  return {
      Confidence::kLow,
      fmt::format("{} of the {} landmarks on one side of observation {} {} seen on the other side, too: a "
                  "slip of odometry there makes landmarks that are not there",
                  least.common == 0 ? "none" : fmt::format("only {}", least.common), least.of, number,
                  least.common == 1 ? "was" : "were")};
}

}  // namespace cairn::datasets
