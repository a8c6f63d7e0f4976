#include "schema/kinds/few_in_common.h"

#include <algorithm>
#include <map>
#include <set>

namespace cairn {
namespace {

// Of one robot's observations that are of a landmark: the number of the first and of the last one of each.
struct Seen {
  std::size_t first = 0, last = 0;
};

struct RobotSeen {
  std::map<std::int32_t, Seen> landmarks;
  std::vector<std::size_t> number;  // of these observations, among all of the robot's, from 1 on
};

RobotSeen SeenIn(std::span<const std::int32_t> landmarks) {
  RobotSeen seen;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (landmarks[i] < 0) continue;
    const std::size_t at = seen.number.size();
    seen.number.push_back(i + 1);
    seen.landmarks.try_emplace(landmarks[i], at, at).first->second.last = at;
  }
  return seen;
}

// What robot r has seen up to its observation `at` and after it; `others`: what each of the others saw.
FewInCommon InCommonAt(const std::vector<RobotSeen>& robots, std::size_t r, std::size_t at) {
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
  return {both, std::min(before, after), r, robots[r].number[at]};
}

}  // namespace

FewInCommon FindFewestInCommon(const std::vector<std::span<const std::int32_t>>& landmarks) {
  constexpr std::size_t kEnds = 10, kLeast = 3;  // a tenth; of fewer landmarks it may be chance
  std::vector<RobotSeen> robots;
  for (const auto& of : landmarks) robots.push_back(SeenIn(of));
  FewInCommon least;
  for (std::size_t r = 0; r < robots.size(); ++r) {
    const std::size_t end = robots[r].number.size() / kEnds;
    std::set<std::size_t> changes = {end};  // between these nothing does
    for (const auto& [landmark, seen] : robots[r].landmarks) changes.insert({seen.first, seen.last});
    for (const std::size_t at : changes) {
      if (at < end || at + 1 + end >= robots[r].number.size()) continue;
      const FewInCommon here = InCommonAt(robots, r, at);
      if (here.of >= kLeast && here.IsLessThan(least)) least = here;
    }
  }
  return least;
}

}  // namespace cairn
