#include "datasets/verdicts/landmarks_on_one_side.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "schema/kinds/few_in_common.h"

namespace cairn::datasets {
namespace {

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
                      "and see the same ones twice, or the search stopped short of where it came back: to "
                      "state how the heading drifts (--heading-drift-rad-per-m) or some names would tell",
                      one_sided, one_sided + two_sided, map.fit.one_sided_s.Or(0))};
}

Verdict::Doubt OfFewInCommon(const kinds::LandmarkMap& map, Verdict* verdict) {
  constexpr double kTied_nats = 10;
  if (std::ranges::none_of(map.map.landmark_identity.OrNone(), [](int id) { return id < 0; }))
    return {Confidence::kHigh};
  std::vector<std::span<const std::int32_t>> landmarks;
  for (const kinds::LandmarkMap::Robot& robot : map.robot) landmarks.push_back(robot.map_landmark.OrNone());
  const FewInCommon least = FindFewestInCommon(landmarks);
  if (!least.AreFew()) return {Confidence::kHigh};
  verdict->AddCount("fewest_landmarks_in_common", least.common);
  verdict->AddCount("fewest_landmarks_in_common_of", least.of);
  if (const auto nats = map.fit.few_common_lead_nats.Optional()) {
    verdict->numbers.emplace_back("fewest_landmarks_in_common_lead_nats", *nats);
    if (*nats >= kTied_nats) return {Confidence::kHigh};
  }
  return {
      Confidence::kLow,
      fmt::format("{} of the {} landmarks on one side of observation {} {} seen on the other side, too: a "
                  "slip of odometry there makes landmarks that are not there",
                  least.common == 0 ? "none" : fmt::format("only {}", least.common), least.of, least.number,
                  least.common == 1 ? "was" : "were")};
}

}  // namespace cairn::datasets
