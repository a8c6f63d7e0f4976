#include "datasets/common/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>

#include "datasets/common/moved_landmarks.h"
#include "datasets/common/wall_turns.h"
#include "schema/kinds/grid_map.h"
#include "schema/kinds/landmark_map.h"
#include "schema/kinds/learning.h"
#include "schema/kinds/local_map.h"

namespace cairn::datasets {
namespace {

void AddCount(const std::string& name, std::size_t count, Verdict* verdict) {
  verdict->numbers.emplace_back(name, static_cast<double>(count));
}

// How many of the maps that were called so were right: 375 of 376, 27 of 30, 4 of 13.
const char* Frequency(Confidence confidence) {
  if (confidence == Confidence::kHigh) return "99 of 100";
  return confidence == Confidence::kFair ? "9 of 10" : "3 of 10";
}

// In what the job differs from those on which the rates were measured; none: in nothing.
std::optional<std::string> Unlike(const kinds::LandmarkMap::Search& search) {
  if (!search.unlike) return "the file does not say what it was made from";
  std::string all;
  for (const std::string& what : search.unlike) all += (all.empty() ? "" : ", ") + what;
  if (all.empty()) return {};
  return all;
}

std::string FoundText(const kinds::LandmarkMap::Search& search) {
  const std::optional<double> lead = search.lead_nats.Optional();
  const std::string ahead =
      lead ? fmt::format("{:.1f} nats ahead of the next different map", *lead) : "no other map was found";
  return fmt::format("found from {} of {} starts, {}", search.support.Or(0), search.starts.Or(0), ahead);
}

// What the search says of the map it chose.
Verdict SearchVerdict(const Blob& result, bool at_a_distance) {
  Verdict verdict;
  const auto search = FieldsIn<kinds::LandmarkMap::Search>("search/", result);
  const Confidence confidence = ReadConfidence(result);
  if (confidence == Confidence::kNone) {
    verdict.why = "there was no search";
    return verdict;
  }
  verdict.numbers = {{"starts", search.starts.Or(0)}, {"starts_that_found_it", search.support.Or(0)}};
  if (const auto lead = search.lead_nats.Optional()) verdict.numbers.emplace_back("lead_nats", *lead);
  const std::string found = FoundText(search);
  if (search.starts.Or(0) == 1) {
    verdict.why = "EM started once, no other map to compare with";
    if (search.why) verdict.why += " (" + search.why.Scalar() + ")";
  } else if (at_a_distance) {
    // Not high: of simulated loops two in ten came out wrong though all starts agreed and everything fitted.
    verdict.trust = std::min(confidence, Confidence::kFair);
    verdict.why = found;
  } else if (const auto unlike = Unlike(search)) {
    verdict.why = found + "; how often such maps are right was not measured (" + *unlike + ")";
  } else {
    verdict.trust = confidence;
    verdict.why = std::string("right in ") + Frequency(confidence) + " such simulations; " + found;
  }
  return verdict;
}

// From when to when, in seconds.
using Span = std::pair<double, double>;

struct WeakestTime {
  double time_s = 0;
  std::size_t spans = 0;  // that go over it
};

// A loop that the path follows: from when to when, and along which axes it tells how far both lie apart.
struct Tie {
  Span span;
  bool x = true, y = true;
};

// Of the time from the first span's start to the last one's end, without a tenth at either end.
WeakestTime FindWeakestTime(const std::vector<Span>& spans) {
  constexpr double kEnds = 0.1;
  std::vector<std::pair<double, int>> changes;
  double first_s = spans.front().first, last_s = spans.front().second;
  for (const auto& [from_s, to_s] : spans) {
    changes.emplace_back(from_s, 1);
    changes.emplace_back(to_s, -1);
    first_s = std::min(first_s, from_s);
    last_s = std::max(last_s, to_s);
  }
  std::ranges::sort(changes);
  const double begin_s = std::lerp(first_s, last_s, kEnds), end_s = std::lerp(first_s, last_s, 1 - kEnds);
  WeakestTime weakest{begin_s, spans.size()};
  std::ptrdiff_t over = 0;
  for (std::size_t i = 0; i + 1 < changes.size(); ++i) {
    over += changes[i].second;
    const bool within = changes[i + 1].first > begin_s && changes[i].first < end_s;
    if (!within || changes[i].first == changes[i + 1].first ||
        static_cast<std::size_t>(over) >= weakest.spans)
      continue;
    weakest = {std::max(begin_s, changes[i].first), static_cast<std::size_t>(over)};
  }
  return weakest;
}

// Of those that tell the distance along that axis which fewer tell.
WeakestTime FindWeakestAxis(const std::vector<Tie>& ties) {
  WeakestTime weakest{0, ties.size()};
  for (const bool Tie::* axis : {&Tie::x, &Tie::y}) {
    std::vector<Span> spans;
    for (const Tie& tie : ties)
      if (tie.*axis) spans.push_back(tie.span);
    const WeakestTime time = spans.empty() ? WeakestTime{ties.front().span.first, 0} : FindWeakestTime(spans);
    if (time.spans < weakest.spans) weakest = time;
  }
  return weakest;
}

// What lowers the trust in a map, and the words for it.
struct Doubt {
  Confidence at_most = Confidence::kFair;
  std::string text = {};  // empty: there is none
};

// kLow from `much` on, kFair from `some` on.
Confidence AtMost(double value, double some, double much) {
  if (value > much) return Confidence::kLow;
  return value > some ? Confidence::kFair : Confidence::kHigh;
}

Doubt OfMisfits(const kinds::LandmarkMap::Fit& fit) {
  constexpr double kFew = 0.03, kMany = 0.2, kGross = 6;
  const std::int64_t observations = fit.observations.Scalar(), misfits = fit.misfits.Scalar();
  if (misfits == 0) return {Confidence::kHigh};
  const double share = static_cast<double>(misfits) / static_cast<double>(observations);
  const double worst = fit.worst_sigmas.OrNone().empty() ? 0 : fit.worst_sigmas.OrNone().front();
  const double time_s = fit.worst_time_s.OrNone().empty() ? 0 : fit.worst_time_s.OrNone().front();
  return {
      std::min(AtMost(share, kFew, kMany), worst < kGross ? Confidence::kHigh : Confidence::kFair),
      fmt::format("{} of {} observations {} not fit the map, the worst is {:.1f} standard deviations off, "
                  "at {:.1f} s",
                  misfits, observations, misfits == 1 ? "does" : "do", worst, time_s)};
}

// Widths estimated from the residuals that are far from what was stated of a sensor. Where nothing names the
// landmarks the map may explain each of them by a landmark of its own.
Doubt OfWidths(const kinds::LandmarkMap::Fit& fit) {
  constexpr double kWider = 1.5, kMuchWider = 3;
  double wider = 0;
  for (std::size_t k = 0; k < fit.kind.OrNone().size(); ++k)
    if ((fit.kind[k] == "range" || fit.kind[k] == "bearing") && fit.stated[k] > 0)
      wider = std::max(wider, fit.found[k] / fit.stated[k]);
  if (wider <= kWider) return {Confidence::kHigh};
  return {
      AtMost(wider, kWider, kMuchWider),
      fmt::format("ranges or bearings err by {:.1f} times what is stated, or was expected: is the sensor's "
                  "mount right?",
                  wider)};
}

Doubt OfRun(const kinds::LandmarkMap::Fit& fit) {
  constexpr std::int64_t kLong = 5;
  if (fit.longest_run.Scalar() < kLong) return {Confidence::kHigh};
  return {Confidence::kFair,
          fmt::format("{} in a row do not from {:.1f} s on: were names exchanged, or was a landmark or the "
                      "robot moved?",
                      fit.longest_run.Scalar(), fit.longest_run_from_s.Scalar())};
}

Doubt OfJumps(const kinds::LandmarkMap::Fit& fit) {
  const std::int64_t jumps = fit.odometry_misfits.Or(0);
  if (jumps == 0) return {Confidence::kHigh};
  return {Confidence::kFair,
          fmt::format("odometry does not fit {}, worst at {:.1f} s: did the robot slip, was it carried?",
                      jumps == 1 ? std::string("once") : fmt::format("{} times", jumps),
                      fit.worst_odometry_s.Or(0))};
}

// By how much a scale is off: of one as many times too large as too small.
double Off(double scale) { return std::abs(std::log(scale)); }

// Of the robot whose scale is furthest off; 1 where none has any.
struct FurthestScale {
  std::string robot;
  double scale = 1;
};

FurthestScale FindFurthest(const kinds::LandmarkMap& map, Column<double> kinds::LandmarkMap::Robot::* scale,
                           const char* name, Verdict* verdict) {
  FurthestScale furthest;
  bool any = false;
  for (std::size_t r = 0; r < map.robot.size(); ++r) {
    const double of_robot = (map.robot[r].*scale).Or(1);
    any |= static_cast<bool>(map.robot[r].*scale);
    if (Off(of_robot) > Off(furthest.scale)) furthest = {map.robots[r], of_robot};
  }
  if (any) verdict->numbers.emplace_back(name, furthest.scale);
  return furthest;
}

// Where odometry's distances are not those of the ranges, either may be the one that is wrong, and the map
// has the ranges' scale.
Doubt OfDistances(const kinds::LandmarkMap& map, Verdict* verdict) {
  constexpr double kOff = 0.07, kFarOff = 0.15;
  const auto [robot, scale] =
      FindFurthest(map, &kinds::LandmarkMap::Robot::distance_scale, "distance_scale", verdict);
  const Confidence at_most = AtMost(Off(scale), std::log1p(kOff), std::log1p(kFarOff));
  if (at_most == Confidence::kHigh) return {at_most};
  return {at_most,
          fmt::format("{} has travelled {:.2f} times as far by its ranges as by its odometry: are both in "
                      "metres and calibrated? The map has the scale of the ranges",
                      robot, scale)};
}

// What was found and taken off makes no map worse; but who made the log may want to mend it.
Doubt OfRangeOffsets(const kinds::LandmarkMap& map, Verdict* verdict) {
  std::string robot;
  double furthest_m = 0;
  for (std::size_t r = 0; r < map.robot.size(); ++r) {
    const double offset_m = map.robot[r].range_offset_m.Or(0);
    if (std::abs(offset_m) <= std::abs(furthest_m)) continue;
    robot = map.robots[r];
    furthest_m = offset_m;
  }
  if (furthest_m == 0) return {Confidence::kHigh};
  verdict->numbers.emplace_back("range_offset_m", furthest_m);
  return {Confidence::kHigh, fmt::format("the ranges of {} are {:.2f} m too {}, which was taken off", robot,
                                         std::abs(furthest_m), furthest_m > 0 ? "long" : "short")};
}

// Turns the observations tell well, whatever odometry says: MRCLAM's robots turn three quarters as far as
// theirs, and are mapped well.
Doubt OfTurns(const kinds::LandmarkMap& map, Verdict* verdict) {
  constexpr double kOff = 0.15;
  const auto [robot, scale] =
      FindFurthest(map, &kinds::LandmarkMap::Robot::turn_scale, "turn_scale", verdict);
  if (Off(scale) <= std::log1p(kOff)) return {Confidence::kHigh};
  return {
      Confidence::kFair,
      fmt::format("{} has turned {:.2f} times as far by its observations as by its odometry", robot, scale)};
}

// Without names only their own agreement tells maps apart: a sensor that errs more than it should, or a path
// that breaks, weighs more where most starts led to another map.
Doubt WhereStartsDisagree(const kinds::LandmarkMap& map, Doubt doubt) {
  const bool disagree = map.search.support && 2 * map.search.support.Scalar() < map.search.starts.Or(0);
  if (doubt.text.empty() || !disagree) return doubt;
  return {Confidence::kLow, doubt.text + "; most starts led to another map"};
}

// Of landmarks that observations name there is no search: the fit of the least squares is what the verdict
// rests on. Else it may lower what the search says.
void JudgeFit(const kinds::LandmarkMap& map, double explained_share, Verdict* verdict) {
  constexpr std::int64_t kMany = 50;
  constexpr double kNearlyAll = 0.9;
  const kinds::LandmarkMap::Fit& fit = map.fit;
  if (!fit.observations) return;
  const std::int64_t observations = fit.observations.Scalar(), misfits = fit.misfits.Scalar();
  verdict->numbers.emplace_back("observations_fitted", static_cast<double>(observations));
  verdict->numbers.emplace_back("misfits", static_cast<double>(misfits));
  verdict->numbers.emplace_back("misfits_in_a_row", static_cast<double>(fit.longest_run.Scalar()));
  verdict->numbers.emplace_back("odometry_misfits", static_cast<double>(fit.odometry_misfits.Or(0)));
  const bool all_named =
      std::ranges::all_of(map.map.landmark_identity.OrNone(), [](int id) { return id >= 0; });
  const bool named = !map.search.support && all_named;
  const bool many = observations >= kMany && explained_share >= kNearlyAll;
  const Confidence by_number = many ? Confidence::kHigh : Confidence::kFair;
  verdict->trust = named ? by_number : std::min(verdict->trust, by_number);
  const std::string fitted = fmt::format("{} observations fit the map", observations - misfits);
  verdict->why = named ? fitted : verdict->why + "; " + fitted;
  for (const Doubt& doubt :
       {OfMisfits(fit), WhereStartsDisagree(map, OfWidths(fit)), WhereStartsDisagree(map, OfRun(fit)),
        WhereStartsDisagree(map, OfJumps(fit)), OfDistances(map, verdict), OfTurns(map, verdict),
        OfRangeOffsets(map, verdict)}) {
    verdict->trust = std::min(verdict->trust, doubt.at_most);
    if (!doubt.text.empty()) verdict->why += "; " + doubt.text;
  }
}

// What a robot travels before its first loop or after its last, where nothing checks the path.
struct Untied {
  double travelled_m = 0, from_s = 0, until_s = 0;
  bool is_long = false;  // for its whole path
};

Untied LongestUntied(const kinds::LocalMap& map, const std::vector<std::vector<Tie>>& closed) {
  constexpr double kLong_m = 20, kLongShare = 0.1;
  Untied longest;
  for (std::size_t r = 0; r < map.robot.size(); ++r) {
    const kinds::PoseTable& poses = map.robot[r].poses;
    double first_s = HUGE_VAL, last_s = -HUGE_VAL;
    for (const Tie& tie : closed[r]) {
      first_s = std::min(first_s, tie.span.first);
      last_s = std::max(last_s, tie.span.second);
    }
    double before_m = 0, after_m = 0, all_m = 0;
    for (std::size_t i = 1; i < poses.time_s.OrNone().size(); ++i) {
      const double step_m = std::hypot(poses.x_m[i] - poses.x_m[i - 1], poses.y_m[i] - poses.y_m[i - 1]);
      all_m += step_m;
      if (poses.time_s[i] <= first_s) before_m += step_m;
      if (poses.time_s[i - 1] >= last_s) after_m += step_m;
    }
    const double most_m = std::max(before_m, after_m);
    if (most_m <= longest.travelled_m) continue;
    const double begin_s = poses.time_s.front(), end_s = poses.time_s.back();
    longest = {.travelled_m = most_m,
               .from_s = after_m >= before_m ? std::max(begin_s, last_s) : begin_s,
               .until_s = after_m >= before_m ? end_s : std::min(end_s, first_s),
               .is_long = most_m > std::max(kLong_m, kLongShare * all_m)};
  }
  return longest;
}

constexpr double kFarTurnScale = 0.1;  // no wheels make that much too much of turns

// How odometry contradicts the right angles of walls.
std::string OtherwiseText(const WallTurns& turns) {
  if (turns.places > 0)
    return fmt::format("{} odometry turns by {:.0f} degrees otherwise",
                       turns.places == 1 ? "once" : std::to_string(turns.places) + " times",
                       turns.place_rad * 180 / std::numbers::pi);
  if (std::abs(turns.turn_scale) > kFarTurnScale)
    return fmt::format("odometry's turns would be {:.0f}% off", 100 * std::abs(turns.turn_scale));
  return "odometry turns otherwise each time a place is passed";
}

// The path takes all walls to stand along two directions at right angles: loops are found on it, and close on
// a map that is bent, too.
Doubt OfWalls(const WallTurns& turns) {
  constexpr double kScale = 0.05, kRadian = std::numbers::pi / 180;
  constexpr double kSteps_rad = 3 * kRadian, kSteps = 4, kAlike = 0.5, kAlike_rad = 1 * kRadian,
                   kOthers = 0.4;
  constexpr std::size_t kPairs = 50;
  if (turns.path_m == 0) return {Confidence::kHigh};
  const bool bends = turns.pairs >= kPairs && turns.alike > kAlike && turns.alike_rad > kAlike_rad;
  const bool steps = turns.rms_rad > std::max(kSteps_rad, kSteps * turns.sd_rad);
  if (bends || steps || std::abs(turns.turn_scale) > kFarTurnScale)
    return {Confidence::kLow, "walls were taken to stand at right angles, but " + OtherwiseText(turns)};
  if (turns.other_share > kOthers)
    return {
        Confidence::kLow,
        fmt::format("{:.0f}% of the scans see hardly any of the walls at right angles that the path rests on",
                    100 * turns.other_share)};
  if (std::abs(turns.turn_scale) > kScale)
    return {Confidence::kFair, fmt::format("odometry's turns are {:.0f}% off, if walls stand at right angles",
                                           100 * std::abs(turns.turn_scale))};
  return {Confidence::kHigh};
}

constexpr std::int32_t kLoop = 2;  // LocalMap::Connections::kind

// By how much a map predicts readings better that it was not made of than one that knows nothing.
void AddCheck(const kinds::GridMap::Fit& fit, Verdict* verdict) {
  constexpr double kTellsNats = 0.1;
  if (fit.checked_readings.Or(0) == 0) return;
  const double gain = fit.checked_nats.Scalar() - fit.ignorant_nats.Scalar();
  AddCount("checked_readings", static_cast<std::size_t>(fit.checked_readings.Scalar()), verdict);
  verdict->numbers.emplace_back("checked_gain_nats", gain);
  if (gain < kTellsNats) {
    verdict->trust = Confidence::kLow;
    verdict->why = fmt::format(
        "{} readings that were left out are hardly likelier in the map of the others than in one that knows "
        "nothing of any place: its poses, its readings or what is believed of its sensors are wrong",
        fit.checked_readings.Scalar());
    return;
  }
  verdict->why = fmt::format(
      "{} readings that were left out are each {:.2f} nats likelier in the map of the others than in one "
      "that knows "
      "nothing of any place; ",
      fit.checked_readings.Scalar(), gain);
}

}  // namespace

Confidence ReadConfidence(const Blob& result) {
  constexpr std::int32_t kFairSupport = 2, kHighSupport = 3;
  constexpr double kFairLead = 3.0, kHighLead = 10.0;
  const auto search = FieldsIn<kinds::LandmarkMap::Search>("search/", result);
  if (!search.support) return Confidence::kNone;
  const std::int32_t support = search.support.Scalar();
  const double lead = search.lead_nats.Or(std::numeric_limits<double>::infinity());
  if (support >= kHighSupport && lead >= kHighLead) return Confidence::kHigh;
  return support >= kFairSupport && lead >= kFairLead ? Confidence::kFair : Confidence::kLow;
}

const char* Word(Confidence confidence) {
  switch (confidence) {
    case Confidence::kNone:
      return "not known";
    case Confidence::kLow:
      return "low";
    case Confidence::kFair:
      return "fair";
    case Confidence::kHigh:
      return "high";
  }
  return "";
}

std::string NotRefined(const Blob& result) {
  const Texts reason = Texts::In(result, "refinement/reason");
  return reason ? reason.Scalar() : "";
}

bool RefinementRefused(const Blob& result) { return NotRefined(result).starts_with("refused"); }

std::string Verdict::Text() const { return std::string(Word(trust)) + ": " + why; }

Verdict LandmarkMapVerdict(const Blob& result) {
  const auto map = Read<kinds::LandmarkMap>(result);
  Verdict verdict = SearchVerdict(result, map.fit.observations.Or(0) > 0);
  std::size_t observations = 0, explained = 0;
  for (const auto& robot : map.robot) {
    observations += robot.map_landmark.OrNone().size();
    for (const std::int32_t landmark : robot.map_landmark.OrNone()) explained += landmark >= 0;
  }
  AddCount("observations", observations, &verdict);
  AddCount("observations_explained", explained, &verdict);
  const auto all = static_cast<double>(std::max<std::size_t>(1, observations));
  JudgeFit(map, static_cast<double>(explained) / all, &verdict);
  if (explained < observations)
    verdict.why +=
        fmt::format("; {} of {} observations {} of none of its landmarks", observations - explained,
                    observations, observations - explained == 1 ? "is" : "are");
  if (const std::string moved = MovedText(result); !moved.empty()) {
    verdict.trust = std::min(verdict.trust, Confidence::kFair);
    verdict.why += "; " + moved;
  }
  if (RefinementRefused(result))
    verdict.why += "; refinement was " + NotRefined(result) + ", the landmarks stand where EM left them";
  return verdict;
}

Verdict LocalMapVerdict(const Blob& result) {
  constexpr std::size_t kHighTies = 20, kFairTies = 5, kHighTiesAlongAxis = 10;
  const auto map = Read<kinds::LocalMap>(result);
  std::size_t loops = 0, contradicted = 0;
  std::vector<std::vector<Tie>> closed(map.robot.size());  // by each robot's loops
  const auto tells_x = map.connections.tells_x.OrNone(), tells_y = map.connections.tells_y.OrNone();
  for (std::size_t i = 0; i < map.connections.kind.OrNone().size(); ++i) {
    if (map.connections.kind[i] != kLoop) continue;
    ++loops;
    contradicted += map.connections.used[i] == 0;
    const auto trace = static_cast<std::size_t>(map.connections.from[i]);
    const auto robot = static_cast<std::size_t>(map.traces.robot[trace]);
    if (map.connections.used[i] != 0 && robot < closed.size())
      closed[robot].push_back({std::minmax(map.connections.from_s[i], map.connections.to_s[i]),
                               tells_x.empty() || tells_x[i] != 0, tells_y.empty() || tells_y[i] != 0});
  }
  Verdict verdict;
  AddCount("loops", loops, &verdict);
  AddCount("loops_contradicted", contradicted, &verdict);
  if (loops == contradicted) {
    verdict.why = "no place was recognised twice, so nothing checks the path";
    return verdict;
  }
  WeakestTime weakest{0, loops}, weakest_axis{0, loops};
  for (const std::vector<Tie>& of_robot : closed) {
    if (of_robot.empty()) continue;
    std::vector<Span> spans;
    for (const Tie& tie : of_robot) spans.push_back(tie.span);
    if (const WeakestTime time = FindWeakestTime(spans); time.spans < weakest.spans) weakest = time;
    if (const WeakestTime time = FindWeakestAxis(of_robot); time.spans < weakest_axis.spans)
      weakest_axis = time;
  }
  AddCount("loops_over_weakest_time", weakest.spans, &verdict);
  AddCount("loops_along_weakest_axis", weakest_axis.spans, &verdict);
  const Untied untied = LongestUntied(map, closed);
  verdict.numbers.emplace_back("untied_m", untied.travelled_m);
  if (5 * contradicted > loops || weakest.spans < kFairTies)
    verdict.trust = Confidence::kLow;
  else
    verdict.trust = weakest.spans >= kHighTies && weakest_axis.spans >= kHighTiesAlongAxis &&
                            50 * contradicted <= loops && !untied.is_long
                        ? Confidence::kHigh
                        : Confidence::kFair;
  verdict.why = contradicted == 0 ? fmt::format("the path closes all of {} loops", loops)
                                  : fmt::format("{} of {} loops contradict the path", contradicted, loops);
  if (untied.is_long)
    verdict.why += fmt::format(
        "; from {:.0f} to {:.0f} s, over {:.0f} m, no place is recognised, and nothing checks the "
        "path",
        untied.from_s, untied.until_s, untied.travelled_m);
  if (weakest.spans < kHighTies)
    verdict.why += fmt::format(
        "; what comes after {:.0f} s hangs on {} of them, and where a robot slipped or was "
        "carried nothing else says so",
        weakest.time_s, weakest.spans);
  else if (weakest_axis.spans < kHighTiesAlongAxis)
    verdict.why += fmt::format(
        "; along one direction, as of a blank corridor, what comes after {:.0f} s hangs on {} of them, and "
        "where a "
        "robot slipped that way nothing else says so",
        weakest_axis.time_s, weakest_axis.spans);
  for (std::size_t r = 0; r < map.robot.size(); ++r) {
    const WallTurns turns = FindWallTurns(map.robot[r]);
    verdict.numbers.emplace_back("walls_turn_scale", turns.turn_scale);
    verdict.numbers.emplace_back("walls_turns_rms_rad", turns.rms_rad);
    verdict.numbers.emplace_back("walls_turns_alike", turns.alike);
    AddCount("walls_turns_places", turns.places, &verdict);
    const Doubt doubt = OfWalls(turns);
    verdict.trust = std::min(verdict.trust, doubt.at_most);
    if (!doubt.text.empty() && verdict.why.find(doubt.text) == std::string::npos)
      verdict.why += "; " + doubt.text;
  }
  return verdict;
}

Verdict GridMapVerdict(const Blob& result) {
  constexpr std::int32_t kNothingDetected = -1, kRandom = -2, kLost = -4;
  const auto map = Read<kinds::GridMap>(result);
  std::size_t readings = 0, explained = 0;
  for (const auto& robot : map.robot) {
    for (const auto& sensor : robot.sensors) {
      for (const std::int32_t cause : sensor.cause.OrNone()) {
        if (cause < kLost || cause == kRandom - 1) continue;  // not used, or beyond the map
        ++readings;
        explained += cause >= kNothingDetected;
      }
    }
  }
  Verdict verdict;
  AddCheck(map.fit, &verdict);
  if (verdict.trust == Confidence::kNone)
    verdict.why += "the map is as good as the poses it is made with, and cannot tell how good they are";
  if (map.cut_short.Or(0) != 0)
    verdict.why += "; its search ended because 'rounds' allows no more, not because nothing was left to find";
  if (readings == 0) return verdict;
  AddCount("readings", readings, &verdict);
  AddCount("readings_explained", explained, &verdict);
  verdict.why +=
      fmt::format("; it explains {:.1f}% of {} readings",
                  100.0 * static_cast<double>(explained) / static_cast<double>(readings), readings);
  return verdict;
}

Verdict NetworksVerdict(const Blob& result) {
  const auto networks = Read<kinds::Networks>(result);
  const std::span<const double> held_out = networks.history.validation_error_m.OrNone();
  std::size_t best = held_out.size();
  for (std::size_t step = 0; step < held_out.size(); ++step)
    if (std::isfinite(held_out[step]) && (best == held_out.size() || held_out[step] < held_out[best]))
      best = step;
  Verdict verdict;
  const double prior = networks.prior_error_m.Or(NAN),
               held_out_prior = networks.validation_prior_error_m.Or(NAN);
  if (best == held_out.size() || !(held_out_prior > 0) || !(prior > 0)) {
    verdict.why =
        "no run was held out of their training ('holdout'), and nothing else tells what they are worth on "
        "another";
    return verdict;
  }
  const double reduced = 1 - held_out[best] / held_out_prior;
  const double reduced_in_training = 1 - networks.history.training_error_m[best] / prior;
  verdict.numbers = {{"held_out_reduction", reduced}, {"training_reduction", reduced_in_training}};
  verdict.trust = reduced > 0 && 2 * reduced >= reduced_in_training ? Confidence::kFair : Confidence::kLow;
  if (reduced <= 0) {
    verdict.why =
        "on the run that was held out they are of no more use than a detector that always says the same";
    return verdict;
  }
  verdict.why = fmt::format(
      "on the run that was held out they take {:.1f}% off the error of a robot that senses nothing, on those "
      "that they "
      "were trained on {:.1f}%",
      100 * reduced, 100 * reduced_in_training);
  verdict.why += verdict.trust == Confidence::kLow
                     ? ": most of what they have learned is of no use elsewhere"
                     : "; which step's weights are kept was chosen by the former, so it is a little too good";
  return verdict;
}

}  // namespace cairn::datasets
