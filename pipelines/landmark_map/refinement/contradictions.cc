#include "pipelines/landmark_map/refinement/contradictions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "schema/kinds/constant_observations.h"
#include "schema/kinds/log.h"
#include "schema/kinds/odometry_holes.h"

namespace cairn::landmark_map {
namespace {

constexpr double kShareElsewhere = 0.25, kLeastElsewhere = 4.0;  // of a landmark's observations

constexpr const char* kCausesOfNamed =
    "do bearings grow counter-clockwise from ahead, are ranges in metres, does the sensor sit where the "
    "robot "
    "turns about and look ahead (`cairn import csv --sensor-mount`), do odometry and observations use "
    "one clock, was it moved, do several things bear one name, and were identities mixed up?";
constexpr const char* kCausesOfErrors =
    " Or are errors of the sensor or of odometry larger than the log states, or than is taken by default "
    "(`cairn import csv --help`: --contact-m, --range-m, --heading-drift-rad-per-m)?";

// The landmarks that a layer of counts would hold if it could hold several.
std::vector<Landmark> Places(const Layer& count, const MapRules& rules) {
  MapRules several = rules;
  several.types = 0;
  several.classes = {};
  several.core_m = std::max(5.0 * rules.observation_m, 3.0 * rules.grid.cell_m);
  LayeredGrid layer;
  layer.layers.push_back(count);
  std::vector<Landmark> places = ExtractLandmarks(layer, several);
  std::ranges::stable_sort(places, std::ranges::greater{}, &Landmark::count);
  return places;
}

// How many of them lie around the one that most lie around.
std::size_t MostTogether(const std::vector<Eigen::Vector2d>& places, double near_m) {
  std::size_t most = 0;
  for (const Eigen::Vector2d& one : places)
    most = std::max(
        most, static_cast<std::size_t>(std::ranges::count_if(
                  places, [&](const Eigen::Vector2d& other) { return (one - other).norm() <= near_m; })));
  return most;
}

// What the log shows that may be the cause.
std::string CausesIn(const Blob& log) {
  std::string text;
  for (const auto& causes : {ConstantObservationsOf(log), OdometryHolesOf(log)})
    for (const std::string& cause : causes) text += "; " + cause;
  return text;
}

// Where each other robot names a landmark that the first one names too, none was somewhere else: who saw
// what. Empty where there is such a robot that names none.
std::string SeenByTwo(const kinds::Log& log) {
  std::string text;
  const auto of_first = log.robot[0].observations.landmark.OrNone();
  const std::set<std::int32_t> named(of_first.begin(), of_first.end());
  for (std::size_t r = 1; r < log.robot.size(); ++r) {
    const auto seen = log.robot[r].observations.landmark.OrNone();
    const auto both = std::ranges::find_if(seen, [&](std::int32_t k) { return k >= 0 && named.contains(k); });
    if (both == seen.end()) return "";
    if (r == 1)
      text = "'" + log.robots[0] + "' and '" + log.robots[1] + "' have both seen '" +
             log.landmarks[static_cast<std::size_t>(*both)] + "': ";
  }
  return text;
}

// Where some robots give names, and this one and the first do not both give two: what is missing.
std::string NamesMissing(const kinds::Log& log, std::size_t robot) {
  constexpr std::size_t kEnough = 2;
  std::set<std::int32_t> first, both;
  bool any = false;
  for (std::size_t r = 0; r < log.robot.size(); ++r) {
    for (const std::int32_t k : log.robot[r].observations.landmark.OrNone()) {
      any |= k >= 0;
      if (k >= 0 && r == 0) first.insert(k);
      if (k >= 0 && r == robot && first.contains(k)) both.insert(k);
    }
  }
  if (!any || both.size() >= kEnough) return "";
  return " Names would tell: '" + log.robots[0] + "' and '" + log.robots[robot] + "' name " +
         (both.empty() ? "no landmark" : "only one landmark") +
         " in common, so that only where landmarks stand could place it. Give two landmarks at least that "
         "both saw the same names, or map each robot by itself.";
}

}  // namespace

std::vector<InTwoPlaces> LandmarksInTwoPlaces(const LayeredGrid& counts, const MapRules& rules,
                                              const Blob& log) {
  const std::vector<std::string> names = log.Texts("landmarks");
  std::vector<InTwoPlaces> found;
  for (int type = 0; type < rules.types; ++type) {
    const Layer& count = counts.layers[static_cast<std::size_t>(type)];
    if (count.Sum() < 2.0 * kLeastElsewhere) continue;
    const std::vector<Landmark> places = Places(count, rules);
    if (places.size() < 2 || places[1].count < std::max(kLeastElsewhere, kShareElsewhere * count.Sum()))
      continue;
    const std::string text = fmt::format(
        "the log contradicts itself: landmark '{}' stands in two places: {:.0f} of its {:.0f} observations "
        "are "
        "around ({:.2f}, {:.2f}) m, {:.0f} around ({:.2f}, {:.2f}) m; {}",
        names[static_cast<std::size_t>(type)], places[0].count, count.Sum(), places[0].x_m, places[0].y_m,
        places[1].count, places[1].x_m, places[1].y_m, kCausesOfNamed);
    found.push_back({type,
                     std::hypot(places[0].x_m - places[1].x_m, places[0].y_m - places[1].y_m),
                     text + CausesIn(log),
                     {places[0].x_m, places[0].y_m},
                     {places[1].x_m, places[1].y_m}});
  }
  return found;
}

std::vector<InTwoPlaces> StillInTwoPlaces(const std::vector<InTwoPlaces>& found,
                                          const std::vector<Landmark>& landmarks, const ModelFit* fit) {
  std::vector<InTwoPlaces> still;
  for (const InTwoPlaces& landmark : found) {
    const auto at = std::ranges::find(landmarks, landmark.type, &Landmark::type);
    if (fit == nullptr || at == landmarks.end()) {
      still.push_back(landmark);
      continue;
    }
    const std::vector<Eigen::Vector2d>& off_m = fit->off_m[static_cast<std::size_t>(at - landmarks.begin())];
    const double near_m = 0.25 * landmark.apart_m;
    std::vector<Eigen::Vector2d> elsewhere;
    for (const Eigen::Vector2d& off : off_m)
      if (off.norm() > near_m) elsewhere.push_back(off);
    const double many = std::max(kLeastElsewhere, kShareElsewhere * static_cast<double>(off_m.size()));
    if (static_cast<double>(elsewhere.size()) >= many &&
        2 * MostTogether(elsewhere, near_m) > elsewhere.size())
      still.push_back(landmark);
  }
  return still;
}

void CheckRobotsFitTheMap(const RoundSum& sum, const std::vector<Perception>& perceptions,
                          const std::vector<RobotSteps>& steps, const Blob& log) {
  const std::vector<std::string> robots = log.Texts("robots");
  for (std::size_t r = 1; r < robots.size(); ++r) {
    const Perception& perception = perceptions[r];
    double all_false = 0.0, count = 0.0;
    for (const Observation& seen : steps[r].observations) {
      if (perception.Of(seen.type).box.empty()) continue;
      all_false += std::log(perception.OutsideOf(seen.type));
      ++count;
    }
    const double gain = sum.log_likelihood_of(r) - all_false;
    if (gain > kLeastGain * count) continue;
    const std::string than_false =
        gain < 0 ? fmt::format("{:.1f} nats less likely there than if every one were false", -gain)
                 : fmt::format(
                       "{:.1f} nats likelier there than if every one were false, and more than {:.1f} "
                       "would be where it belongs",
                       gain, kLeastGain * count);
    const std::string text = fmt::format(
        "robot '{}' fits nowhere into the first robot's map: its {:.0f} observations are {}; was it ever "
        "where the first robot was, and is its odometry in metres, as its ranges are (not in feet)?",
        robots[r], count, than_false);
    throw RobotsContradictError(text + NamesMissing(Read<kinds::Log>(log), r) + kCausesOfErrors +
                                CausesIn(log));
  }
}

void CheckRobotsAgree(const RoundSum& sum, const Blob& history, double places, std::size_t observations,
                      const Blob& log) {
  const auto robots = history.Get<std::int64_t>("robots");
  const auto likelihoods = history.Get<double>("log_likelihood");
  const auto joined = std::ranges::find_if(robots, [](std::int64_t count) { return count > 1; });
  if (joined == robots.begin() || joined == robots.end()) return;
  const double alone = likelihoods[static_cast<std::size_t>(joined - robots.begin() - 1)];
  const double lost = alone - sum.log_likelihood_of(0);
  if (lost <= std::max(std::log(places), kMostLoss * static_cast<double>(observations))) return;
  const std::string text = fmt::format(
      "the robots contradict each other: in the map of all, what the first robot saw is {:.1f} nats less "
      "likely than in its own; ",
      lost);
  const std::string seen = SeenByTwo(Read<kinds::Log>(log));
  const std::string causes = seen.empty() ? "was one of them somewhere else?" : seen + kCausesOfNamed;
  throw RobotsContradictError(text + causes + kCausesOfErrors + CausesIn(log));
}

}  // namespace cairn::landmark_map
