#include "datasets/common/landmarks_on_one_side.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

namespace cairn::datasets {

Verdict::Doubt OfLandmarksOnOneSide(const kinds::LandmarkMap& map, Verdict* verdict) {
  constexpr std::int64_t kLeast = 3, kTimes = 2;
  const std::int64_t one_sided = map.fit.one_sided.Or(0), two_sided = map.fit.two_sided.Or(0);
  const auto& identity = map.map.landmark_identity.OrNone();
  const bool nameless = !identity.empty() && std::ranges::all_of(identity, [](int id) { return id < 0; });
  if (!nameless || one_sided < kLeast || one_sided <= kTimes * two_sided) return {Confidence::kHigh};
  verdict->numbers.emplace_back("landmarks_on_one_side", static_cast<double>(one_sided));
  verdict->numbers.emplace_back("landmarks_on_both_sides", static_cast<double>(two_sided));
  return {Confidence::kLow,
          fmt::format("{} of {} landmarks were seen only before or only after {:.1f} s, though the robot "
                      "looked at their places on both sides of it: it may have slipped or been carried then, "
                      "and see the same ones twice",
                      one_sided, one_sided + two_sided, map.fit.one_sided_s.Or(0))};
}

}  // namespace cairn::datasets
