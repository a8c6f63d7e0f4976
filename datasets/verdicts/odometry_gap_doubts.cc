#include "datasets/verdicts/odometry_gap_doubts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

#include "datasets/verdicts/calibration_doubts.h"

namespace cairn::datasets {
namespace {

bool ClocksDiffer(const kinds::LandmarkMap& map) {
  Verdict aside;
  return !OfClocks(map, &aside).text.empty();
}

}  // namespace

Verdict::Doubt OfJumps(const kinds::LandmarkMap& map) {
  const std::int64_t jumps = map.fit.odometry_misfits.Or(0);
  if (jumps == 0) return {Confidence::kHigh};
  const auto& identity = map.map.landmark_identity.OrNone();
  const bool nameless = !identity.empty() && std::ranges::all_of(identity, [](int id) { return id < 0; });
  constexpr double kTied_nats = 10;
  const double lead_nats = map.fit.odometry_break_lead_nats.Or(kTied_nats);
  return {
      nameless || lead_nats < kTied_nats ? Confidence::kLow : Confidence::kFair,
      fmt::format(
          "odometry does not fit {}, worst at {:.1f} s: {}{}{}",
          jumps == 1 ? std::string("once") : fmt::format("{} times", jumps), map.fit.worst_odometry_s.Or(0),
          ClocksDiffer(map) ? "as where clocks differ, see below" : "did the robot slip, was it carried?",
          lead_nats < kTied_nats
              ? fmt::format(" It may have been another time, which makes another map, {:.1f} nats behind",
                            lead_nats)
              : "",
          nameless ? (lead_nats < kTied_nats ? ". " : " ") +
                         std::string("Without names a slip makes landmarks that are not there")
                   : "")};
}

Verdict::Doubt OfHalves(const kinds::LandmarkMap::Fit& fit) {
  constexpr std::int64_t kEnough = 2;
  if (fit.fewest_common.Or(kEnough) >= kEnough) return {Confidence::kHigh};
  return {
      Confidence::kFair,
      fmt::format("what was seen before {:.1f} s and after hangs together by {}odometry alone: a slip there "
                  "would not show",
                  fit.fewest_common_s.Or(0), fit.fewest_common.Scalar() == 0 ? "" : "one landmark and ")};
}

Verdict::Doubt OfHoles(const kinds::LandmarkMap& map, Verdict* verdict) {
  constexpr std::int64_t kEnough = 2;
  constexpr double kTied_nats = 10;
  const kinds::LandmarkMap::Holes& holes = map.holes;
  const std::size_t count = holes.robot.OrNone().size();
  if (count == 0) return {Confidence::kHigh};
  const auto is_loose = [&](std::size_t k) {
    return holes.shared_landmarks[k] < kEnough || holes.lead_nats[k] < kTied_nats;
  };
  std::size_t worst = 0;  // a loose one, the longest of them
  for (std::size_t k = 1; k < count; ++k)
    if (is_loose(k) != is_loose(worst) ? is_loose(k) : holes.length_s[k] > holes.length_s[worst]) worst = k;
  verdict->numbers.emplace_back("odometry_hole_s", holes.length_s[worst]);
  std::string text =
      fmt::format("the odometry of {} lacks {:.1f} s from {:.1f} s on, some {:.1f} m of its way",
                  map.robots[static_cast<std::size_t>(holes.robot[worst])], holes.length_s[worst],
                  holes.from_s[worst], holes.missing_m[worst]);
  if (is_loose(worst))
    text += ", and what it saw before and after has too little in common to tell where it went on";
  if (count > 1) text += fmt::format("; it lacks more {} times", count - 1);
  return {is_loose(worst) ? Confidence::kLow : Confidence::kFair, text};
}

}  // namespace cairn::datasets
