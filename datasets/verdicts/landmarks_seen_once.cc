#include "datasets/verdicts/landmarks_seen_once.h"

#include <fmt/format.h>

#include <cstdint>
#include <vector>

namespace cairn::datasets {

SeenOnce CountSeenOnce(const kinds::LandmarkMap& map) {
  SeenOnce seen{.landmarks = map.map.landmark_x_m.OrNone().size()};
  std::vector<int> times(seen.landmarks, 0);
  for (const auto& robot : map.robot)
    for (const std::int32_t landmark : robot.map_landmark.OrNone())
      if (landmark >= 0 && static_cast<std::size_t>(landmark) < times.size())
        ++times[static_cast<std::size_t>(landmark)];
  const auto passes = map.map.landmark_passes.OrNone();
  for (std::size_t k = 0; k < times.size(); ++k) {
    if (times[k] != 1) continue;
    ++seen.once;
    if (k < passes.size() && passes[k] > 1) ++seen.passed_again;
  }
  return seen;
}

Verdict::Doubt OfSeenOnce(const SeenOnce& seen, bool at_a_distance) {
  constexpr double kSome = 0.1, kMany = 0.2;
  if (seen.once == 0) return {Confidence::kHigh};
  const auto all = static_cast<double>(seen.landmarks);
  const bool one = seen.once == 1;
  std::string text =
      fmt::format("{} of {} landmark{} {} observed once: nothing confirms {}", seen.once, seen.landmarks,
                  seen.landmarks == 1 ? "" : "s", one ? "was" : "were", one ? "it" : "them");
  if (seen.passed_again == 0) {
    const bool many = at_a_distance && static_cast<double>(seen.once) > kSome * all;
    return {many ? Confidence::kFair : Confidence::kHigh, text};
  }
  const bool it = seen.passed_again == 1;
  text += fmt::format(
      ", and {} passed again and not observed: {} false, or missed? (`cairn import csv --false-ratio` states "
      "what "
      "share "
      "is false, 0 that none is)",
      one ? "it was" : fmt::format("{} of them {}", seen.passed_again, it ? "was" : "were"),
      it ? "is it" : "are they");
  return {std::min(Confidence::kFair, AtMost(static_cast<double>(seen.passed_again), 0, kMany * all)), text};
}

}  // namespace cairn::datasets
