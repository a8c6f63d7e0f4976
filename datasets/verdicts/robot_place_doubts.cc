#include "datasets/verdicts/robot_place_doubts.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>

namespace cairn::datasets {
namespace {

// Of two robots each is as loose as the other, and the frame is of one of them: of the other it is said, if
// of both.
std::size_t FirstToPlace(const kinds::LandmarkMap& map) {
  return map.robot.size() == 2 && map.robot[1].place_lead_nats ? 1 : 0;
}

}  // namespace

Verdict::Doubt OfPlaces(const kinds::LandmarkMap& map, Verdict* verdict) {
  // Of contact detections their order tells a place, too, which the lead does not weigh.
  const double tied_nats = map.fit.observations.Or(0) > 0 ? 10 : 4;
  std::string loose;
  double least_nats = std::numeric_limits<double>::infinity();
  std::int64_t shared = 0, one_sided = 0;
  for (std::size_t r = FirstToPlace(map); r < map.robot.size(); ++r) {
    const kinds::LandmarkMap::Robot& robot = map.robot[r];
    const std::optional<double> nats = robot.place_lead_nats.Optional();
    if (!nats) continue;
    if (*nats < least_nats) {
      least_nats = *nats;
      shared = robot.shared_landmarks.Or(0);
      one_sided = robot.one_sided_landmarks.Or(0);
    }
    if (*nats < tied_nats) loose += (loose.empty() ? "" : ", ") + map.robots[r];
  }
  if (std::isinf(least_nats)) return {Confidence::kHigh};
  verdict->numbers.emplace_back("place_lead_nats", least_nats);
  if (loose.empty()) return {Confidence::kHigh};
  return {
      Confidence::kLow,
      fmt::format("where {} is in the map of the others is uncertain: {} landmarks in common, {} that one "
                  "side alone has seen though the other looked there, {:.1f} nats {} the next place or none; "
                  "two landmarks that both name would tell; the path of each robot alone may be right",
                  loose, shared, one_sided, std::abs(least_nats), least_nats < 0 ? "behind" : "ahead of")};
}

Verdict::Doubt OfChance(const kinds::LandmarkMap& map, Verdict* verdict) {
  constexpr double kTied_nats = 10;  // below that OfPlaces says it
  const double fair_nats = std::log(9.0), high_nats = std::log(99.0);
  std::optional<std::size_t> least;
  for (std::size_t r = FirstToPlace(map); r < map.robot.size(); ++r) {
    if (!map.robot[r].place_odds_nats || map.robot[r].place_lead_nats.Or(0) < kTied_nats) continue;
    if (!least || map.robot[r].place_odds_nats.Scalar() < map.robot[*least].place_odds_nats.Scalar())
      least = r;
  }
  if (!least || map.fit.observations.Or(0) == 0) return {Confidence::kHigh};  // of contacts their order tells
  const kinds::LandmarkMap::Robot& robot = map.robot[*least];
  const double nats = robot.place_odds_nats.Scalar();
  verdict->numbers.emplace_back("place_odds_nats", nats);
  if (nats >= high_nats) return {Confidence::kHigh};
  const bool fair = nats >= fair_nats;
  const std::string often =
      nats <= 0 ? "in any such map" : fmt::format("in one of {:.0f} such maps", std::exp(nats));
  return {
      fair ? Confidence::kFair : Confidence::kLow,
      fmt::format(
          "where {} is in the map of the others {} be chance: {} landmarks in common, and {} that one side "
          "alone has seen though the other looked there, chance alone gives {}. Two landmarks that both "
          "name would tell",
          map.robots[*least], fair ? "may" : "may well", robot.shared_landmarks.Or(0),
          robot.one_sided_landmarks.Or(0), often)};
}

Verdict::Doubt OfOneSided(const kinds::LandmarkMap& map, Verdict* verdict) {
  constexpr double kTied_nats = 10;
  constexpr double kSome = 0.1, kMany = 0.2;  // of what at least one of the sides saw and both looked at
  constexpr std::int64_t kFew = 2;            // are a doubt where they are many of few
  double most = 0;
  std::size_t robot = 0;
  for (std::size_t r = FirstToPlace(map); r < map.robot.size(); ++r) {
    const kinds::LandmarkMap::Robot& of = map.robot[r];
    const std::int64_t one_sided = of.one_sided_landmarks.Or(0);
    if (one_sided < kFew || of.place_lead_nats.Or(0) < kTied_nats) continue;
    const double share =
        static_cast<double>(one_sided) / static_cast<double>(one_sided + of.shared_landmarks.Or(0));
    if (share > most && (one_sided > kFew || share > kMany)) {
      most = share;
      robot = r;
    }
  }
  if (most > 0) verdict->numbers.emplace_back("one_sided_share", most);
  if (most <= kSome) return {Confidence::kHigh};
  return {
      map.robot[robot].one_sided_landmarks.Or(0) > kFew ? AtMost(most, kSome, kMany) : Confidence::kFair,
      fmt::format("{} and the others have {} landmarks in common, and {} that one side alone has seen "
                  "though the other looked there: do the ranges and bearings of one err by a factor (units, "
                  "field of view), or does it see less?",
                  map.robots[robot], map.robot[robot].shared_landmarks.Or(0),
                  map.robot[robot].one_sided_landmarks.Or(0))};
}

}  // namespace cairn::datasets
