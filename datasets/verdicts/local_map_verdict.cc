#include "datasets/verdicts/local_map_verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "datasets/verdicts/drawn_twice.h"
#include "datasets/verdicts/wall_turns.h"
#include "schema/kinds/local_map.h"

namespace cairn::datasets {
namespace {

constexpr std::int32_t kLoop = 2;  // LocalMap::Connections::kind

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

// When `spans` begin and end, without a share of it at either end.
Span Within(const std::vector<Span>& spans, double ends) {
  Span whole = spans.front();
  for (const auto& [from_s, to_s] : spans)
    whole = {std::min(whole.first, from_s), std::max(whole.second, to_s)};
  return {std::lerp(whole.first, whole.second, ends), std::lerp(whole.first, whole.second, 1 - ends)};
}

double StepM(const kinds::PoseTable& poses, std::size_t i) {
  return std::hypot(poses.x_m[i] - poses.x_m[i - 1], poses.y_m[i] - poses.y_m[i - 1]);
}

// How far a robot has travelled when.
class Travelled {
 public:
  explicit Travelled(const kinds::PoseTable& poses) : time_s_(poses.time_s.OrNone()) {
    for (std::size_t i = 0; i < time_s_.size(); ++i)
      way_m_.push_back(i == 0 ? 0 : way_m_.back() + StepM(poses, i));
  }
  double At(double time_s) const { return Interpolated(time_s_, way_m_, time_s); }
  double When(double way_m) const { return Interpolated(way_m_, time_s_, way_m); }

 private:
  static double Interpolated(std::span<const double> from, std::span<const double> to, double at) {
    const auto next = static_cast<std::size_t>(std::ranges::lower_bound(from, at) - from.begin());
    if (next == 0 || next == from.size()) return next == 0 ? to.front() : to.back();
    return std::lerp(to[next - 1], to[next], (at - from[next - 1]) / (from[next] - from[next - 1]));
  }

  std::span<const double> time_s_;
  std::vector<double> way_m_;
};

// No span can go over the first and the last metres: a tenth of the way, but no more than so far. By way and
// not by time: a robot that stands makes no end longer.
Span WithoutEnds(const std::vector<Span>& spans, const kinds::PoseTable& poses, double most_m) {
  constexpr double kEnds = 0.1;
  const Span whole = Within(spans, 0);
  if (poses.time_s.OrNone().empty()) return Within(spans, kEnds);
  const Travelled travelled(poses);
  const double from_m = travelled.At(whole.first), to_m = travelled.At(whole.second),
               ends_m = std::min(most_m, kEnds * (to_m - from_m));
  if (ends_m == 0) return Within(spans, kEnds);
  return {travelled.When(from_m + ends_m), travelled.When(to_m - ends_m)};
}

WeakestTime FindWeakestTime(const std::vector<Span>& spans, const Span& when) {
  std::vector<std::pair<double, int>> changes{{when.first, 0}, {when.second, 0}};
  for (const auto& [from_s, to_s] : spans) {
    changes.emplace_back(from_s, 1);
    changes.emplace_back(to_s, -1);
  }
  std::ranges::sort(changes);
  WeakestTime weakest{when.first, spans.size()};
  std::ptrdiff_t over = 0;
  for (std::size_t i = 0; i + 1 < changes.size(); ++i) {
    over += changes[i].second;
    const bool within = changes[i + 1].first > when.first && changes[i].first < when.second;
    if (!within || changes[i].first == changes[i + 1].first ||
        static_cast<std::size_t>(over) >= weakest.spans)
      continue;
    weakest = {std::max(when.first, changes[i].first), static_cast<std::size_t>(over)};
  }
  return weakest;
}

// Of those that tell the distance along that axis which fewer tell, over the same time as of all, without a
// tenth of the way at either end: few rooms and corridors show soon how far along them a robot is.
WeakestTime FindWeakestAxis(const std::vector<Tie>& ties, const kinds::PoseTable& poses) {
  std::vector<Span> all;
  for (const Tie& tie : ties) all.push_back(tie.span);
  const Span when = WithoutEnds(all, poses, HUGE_VAL);
  WeakestTime weakest{when.first, ties.size()};
  for (const bool Tie::* axis : {&Tie::x, &Tie::y}) {
    std::vector<Span> spans;
    for (const Tie& tie : ties)
      if (tie.*axis) spans.push_back(tie.span);
    const WeakestTime time = FindWeakestTime(spans, when);
    if (time.spans < weakest.spans) weakest = time;
  }
  return weakest;
}

// The longest way of a robot, between loops that tell how far along an axis it is, over which none does:
// there that coordinate is odometry's alone. All of its way where none tells of an axis.
double LongestOpenWay(const std::vector<Tie>& ties, const kinds::PoseTable& poses) {
  double longest_m = 0;
  for (const bool Tie::* axis : {&Tie::x, &Tie::y}) {
    std::vector<Span> spans;
    for (const Tie& tie : ties)
      if (tie.*axis) spans.push_back(tie.span);
    std::ranges::sort(spans);
    const Span when = spans.empty() ? Span(-HUGE_VAL, HUGE_VAL) : Within(spans, 0);
    double way_m = 0, held_until_s = -HUGE_VAL;
    std::size_t next = 0;
    for (std::size_t i = 1; i < poses.time_s.OrNone().size(); ++i) {
      if (poses.time_s[i - 1] < when.first || poses.time_s[i] > when.second) continue;
      for (; next < spans.size() && spans[next].first < poses.time_s[i]; ++next)
        held_until_s = std::max(held_until_s, spans[next].second);
      way_m = held_until_s > poses.time_s[i - 1] ? 0 : way_m + StepM(poses, i);
      longest_m = std::max(longest_m, way_m);
    }
  }
  return longest_m;
}

// Where the local grids show no wall: odometry's headings are the path's.
struct Blind {
  double share = 0, longest_m = 0;  // of the way
};

Blind BlindWay(const kinds::LocalMap::Robot& robot) {
  const std::size_t count = robot.poses.time_s.OrNone().size();
  Blind blind;
  if (robot.walls.strength.OrNone().size() != count) return blind;
  double all_m = 0, blind_m = 0, way_m = 0;
  for (std::size_t i = 1; i < count; ++i) {
    const double step_m = StepM(robot.poses, i);
    all_m += step_m;
    way_m = robot.walls.strength[i] > 0 ? 0 : way_m + step_m;
    if (way_m > 0) blind_m += step_m;
    blind.longest_m = std::max(blind.longest_m, way_m);
  }
  if (all_m > 0) blind.share = blind_m / all_m;
  return blind;
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
      const double step_m = StepM(poses, i);
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
Verdict::Doubt OfWalls(const WallTurns& turns) {
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

// The loops of a path, and those of them that each robot's path follows.
struct Loops {
  std::size_t all = 0, contradicted = 0;
  std::vector<std::vector<Tie>> closed;
};

Loops LoopsOf(const kinds::LocalMap& map) {
  Loops loops;
  loops.closed.resize(map.robot.size());
  const auto tells_x = map.connections.tells_x.OrNone(), tells_y = map.connections.tells_y.OrNone();
  for (std::size_t i = 0; i < map.connections.kind.OrNone().size(); ++i) {
    if (map.connections.kind[i] != kLoop) continue;
    ++loops.all;
    loops.contradicted += map.connections.used[i] == 0;
    const auto trace = static_cast<std::size_t>(map.connections.from[i]);
    const auto robot = static_cast<std::size_t>(map.traces.robot[trace]);
    if (map.connections.used[i] != 0 && robot < loops.closed.size())
      loops.closed[robot].push_back({std::minmax(map.connections.from_s[i], map.connections.to_s[i]),
                                     tells_x.empty() || tells_x[i] != 0, tells_y.empty() || tells_y[i] != 0});
  }
  return loops;
}

// Of all robots' paths the times over which the fewest loops go, and the fewest that tell how far along an
// axis; and the longest way between them over which none does.
struct Weakest {
  WeakestTime time, along_axis;
  double open_m = 0;
};

Weakest FindWeakest(const kinds::LocalMap& map, const Loops& loops) {
  constexpr double kEnd_m = 8;
  Weakest weakest{{0, loops.all + 1}, {0, loops.all + 1}};  // more than there can be
  for (std::size_t r = 0; r < loops.closed.size(); ++r) {
    const std::vector<Tie>& of_robot = loops.closed[r];
    if (of_robot.empty()) continue;
    std::vector<Span> spans;
    for (const Tie& tie : of_robot) spans.push_back(tie.span);
    const WeakestTime least = FindWeakestTime(spans, WithoutEnds(spans, map.robot[r].poses, kEnd_m));
    if (least.spans < weakest.time.spans) weakest.time = least;
    weakest.open_m = std::max(weakest.open_m, LongestOpenWay(of_robot, map.robot[r].poses));
    if (const WeakestTime time = FindWeakestAxis(of_robot, map.robot[r].poses);
        time.spans < weakest.along_axis.spans)
      weakest.along_axis = time;
  }
  return weakest;
}

constexpr std::size_t kHighTies = 20, kFairTies = 5, kHighTiesAlongAxis = 10;
constexpr double kOpen_m = 8;  // rooms and short corridors have shown by then how far along them a robot is

Confidence TrustIn(const Loops& loops, const Weakest& weakest, const Untied& untied) {
  if (5 * loops.contradicted > loops.all || weakest.time.spans < kFairTies || weakest.open_m > kOpen_m)
    return Confidence::kLow;
  const bool high = weakest.time.spans >= kHighTies && weakest.along_axis.spans >= kHighTiesAlongAxis &&
                    50 * loops.contradicted <= loops.all && !untied.is_long;
  return high ? Confidence::kHigh : Confidence::kFair;
}

std::string LoopsText(const Loops& loops, const Weakest& weakest, const Untied& untied) {
  std::string text = loops.contradicted == 0
                         ? fmt::format("the path closes all of {} loops", loops.all)
                         : fmt::format("{} of {} loops contradict the path", loops.contradicted, loops.all);
  if (untied.is_long)
    text += fmt::format(
        "; from {:.0f} to {:.0f} s, over {:.0f} m, no place is recognised, and nothing checks the path",
        untied.from_s, untied.until_s, untied.travelled_m);
  if (weakest.time.spans < kHighTies)
    text += fmt::format(
        "; what comes after {:.0f} s hangs on {} of them, and where a robot slipped or was carried nothing "
        "else says so",
        weakest.time.time_s, weakest.time.spans);
  else if (weakest.along_axis.spans < kHighTiesAlongAxis)
    text += fmt::format(
        "; along one direction, as of a blank corridor, what comes after {:.0f} s hangs on {} of them, and "
        "where a robot slipped that way nothing else says so",
        weakest.along_axis.time_s, weakest.along_axis.spans);
  if (weakest.open_m > kOpen_m)
    text += fmt::format(
        "; over {:.0f} m no loop tells how far along one direction the robot is, and nothing checks that",
        weakest.open_m);
  return text;
}

// A hall whose walls are further away than the local grids reach.
void JudgeBlindWays(const Blob& result, const kinds::LocalMap& map, Verdict* verdict) {
  constexpr double kShare = 0.5, kLong_m = 20;
  for (const kinds::LocalMap::Robot& robot : map.robot) {
    const Blind blind = BlindWay(robot);
    verdict->numbers.emplace_back("blind_share", blind.share);
    if (blind.share <= kShare || blind.longest_m <= kLong_m) continue;
    const double reach_m = LocalGridsReach_m(result);
    verdict->Add({Confidence::kLow,
                  fmt::format("on {:.0f}% of the way, {:.0f} m at a stretch, no wall lies within the local "
                              "grids{}: a greater 'half_cells' lets them see further",
                              100 * blind.share, blind.longest_m,
                              reach_m > 0 ? fmt::format(", which reach {:.1f} m", reach_m) : "")});
  }
}

void JudgeWalls(const kinds::LocalMap& map, Verdict* verdict) {
  for (std::size_t r = 0; r < map.robot.size(); ++r) {
    const WallTurns turns = FindWallTurns(map.robot[r]);
    verdict->numbers.emplace_back("walls_turn_scale", turns.turn_scale);
    verdict->numbers.emplace_back("walls_turns_rms_rad", turns.rms_rad);
    verdict->numbers.emplace_back("walls_turns_alike", turns.alike);
    verdict->AddCount("walls_turns_places", turns.places);
    verdict->Add(OfWalls(turns));
  }
}

// Where odometry's distances are not those of the scans, which the path has.
void JudgeMetre(const kinds::LocalMap& map, Verdict* verdict) {
  constexpr double kOff = 1.07, kFarOff = 1.5, kWalks = 1.001;
  for (const kinds::LocalMap::Robot& robot : map.robot) {
    if (robot.metre.scale.OrNone().empty()) continue;
    const auto [least, most] = std::ranges::minmax(robot.metre.scale);
    verdict->numbers.emplace_back("odometry_metre_least_m", least);
    verdict->numbers.emplace_back("odometry_metre_most_m", most);
    const double off = std::max(most, 1 / least);
    const bool walks = most > kWalks * least;
    verdict->Add({off > kFarOff         ? Confidence::kLow
                  : off > kOff || walks ? Confidence::kFair
                                        : Confidence::kHigh,
                  fmt::format("what odometry calls a metre is {:.2f}{} m by the scans: {} The map has the "
                              "scale of the scans",
                              least, walks ? fmt::format(" to {:.2f}", most) : "",
                              walks ? "its scale drifts, as a camera's does."
                                    : "are both in metres and calibrated?")});
  }
}

constexpr double kDegree = std::numbers::pi / 180;
long Degrees(double rad) { return std::lround(rad / kDegree); }

// Where the scans show another motion than the path has.
Verdict::Doubt OfScans(const kinds::LocalMap::Fit& fit, std::size_t i) {
  if (fit.hole[i] != 0)
    return {
        Confidence::kLow,
        fmt::format("from {:.0f} to {:.0f} s the robot was moved, and odometry did not count it: the scans "
                    "before and after do not meet",
                    fit.from_s[i], fit.until_s[i])};
  constexpr double kMissed_rad = 30 * kDegree, kFollows_rad = 40 * kDegree;
  const double of_path_rad = std::abs(fit.scans_turn_rad[i] - fit.path_turn_rad[i]),
               of_odometry_rad = std::abs(fit.scans_turn_rad[i] - fit.odometry_turn_rad[i]);
  const std::string turns = fmt::format(
      "from {:.0f} to {:.0f} s the scans show a turn by {} degrees and odometry one by {}", fit.from_s[i],
      fit.until_s[i], Degrees(fit.scans_turn_rad[i]), Degrees(fit.odometry_turn_rad[i]));
  if (of_path_rad > (of_odometry_rad > kMissed_rad ? kFollows_rad : kMissed_rad))
    return {Confidence::kLow, turns + fmt::format("; the path has one by {}", Degrees(fit.path_turn_rad[i]))};
  // Loops that close afterwards would close on a path that turned wrongly there, too.
  if (of_odometry_rad > kMissed_rad) return {Confidence::kFair, turns + "; the path follows the scans"};
  // Less does not harm a map.
  constexpr double kMissed_m = 0.5;
  if (fit.apart_m[i] < kMissed_m && fit.odometry_apart_m && fit.odometry_apart_m[i] >= kMissed_m)
    return {
        Confidence::kFair,
        fmt::format("from {:.0f} to {:.0f} s the scans show another way than odometry, {:.1f} m apart: the "
                    "wheels slipped, or the robot was carried; the path follows the scans",
                    fit.from_s[i], fit.until_s[i], fit.odometry_apart_m[i])};
  return {
      Confidence::kLow,
      fmt::format("from {:.0f} to {:.0f} s the scans show another way than the path has, {:.1f} m apart: the "
                  "wheels slipped, or the robot was carried",
                  fit.from_s[i], fit.until_s[i], fit.apart_m[i])};
}

// How bad a disagreement is: radians, and metres likewise.
double Weight(const kinds::LocalMap::Fit& fit, std::size_t i) {
  if (fit.hole[i] != 0) return std::numbers::pi / 2;
  const double of_path_rad = std::abs(fit.scans_turn_rad[i] - fit.path_turn_rad[i]);
  return OfScans(fit, i).at_most == Confidence::kFair ? 0 : std::max(of_path_rad, fit.apart_m[i]);
}

// The worst of each robot is named.
void JudgeScans(const kinds::LocalMap& map, Verdict* verdict) {
  std::size_t all = 0;
  for (const kinds::LocalMap::Robot& robot : map.robot) {
    const std::size_t count = robot.fit.from_s.OrNone().size();
    all += count;
    std::size_t worst = 0;
    for (std::size_t i = 1; i < count; ++i)
      if (Weight(robot.fit, i) > Weight(robot.fit, worst)) worst = i;
    if (count > 0) verdict->Add(OfScans(robot.fit, worst));
  }
  verdict->AddCount("scans_disagree", all);
}

// Without a loop a path that contradicts odometry has nothing for it.
void JudgeUnlooped(const kinds::LocalMap& map, Verdict* verdict) {
  constexpr double kMuch_rad = std::numbers::pi / 2;
  for (std::size_t r = 0; r < map.robot.size(); ++r) {
    const WallTurns turns = FindWallTurns(map.robot[r]);
    Verdict::Doubt doubt = OfWalls(turns);
    if (doubt.at_most > Confidence::kLow && std::abs(turns.drift_rad) > kMuch_rad)
      doubt = {Confidence::kLow,
               fmt::format("walls were taken to stand at right angles, for which odometry would "
                           "have to drift by {} degrees in all",
                           std::abs(Degrees(turns.drift_rad)))};
    if (doubt.at_most > Confidence::kLow) continue;
    verdict->trust = Confidence::kLow;
    verdict->Add(doubt);
  }
  if (verdict->trust == Confidence::kNone &&
      std::ranges::any_of(map.robot, [](const auto& robot) { return !robot.fit.from_s.OrNone().empty(); }))
    verdict->trust = Confidence::kLow;
  JudgeScans(map, verdict);
  JudgeLasers(map, verdict);
}

}  // namespace

Verdict LocalMapVerdict(const Blob& result) {
  const auto map = Read<kinds::LocalMap>(result);
  const Loops loops = LoopsOf(map);
  Verdict verdict;
  verdict.AddCount("loops", loops.all);
  verdict.AddCount("loops_contradicted", loops.contradicted);
  if (loops.all == loops.contradicted) {
    verdict.why = "no place was recognised twice, so nothing checks the path";
    JudgeUnlooped(map, &verdict);
    return verdict;
  }
  const Weakest weakest = FindWeakest(map, loops);
  verdict.AddCount("loops_over_weakest_time", weakest.time.spans);
  verdict.AddCount("loops_along_weakest_axis", weakest.along_axis.spans);
  verdict.numbers.emplace_back("open_along_axis_m", weakest.open_m);
  const Untied untied = LongestUntied(map, loops.closed);
  verdict.numbers.emplace_back("untied_m", untied.travelled_m);
  verdict.trust = TrustIn(loops, weakest, untied);
  verdict.why = LoopsText(loops, weakest, untied);
  JudgeMetre(map, &verdict);
  JudgeWalls(map, &verdict);
  JudgeBlindWays(result, map, &verdict);
  JudgeScans(map, &verdict);
  JudgeLasers(map, &verdict);
  JudgePasses(map, &verdict);
  return verdict;
}

double LocalGridsReach_m(const Blob& result) {
  if (!result.Has("snapshots/occupancy") || !result.Has("cell_m")) return 0;
  const std::int64_t half_cells = result.at("snapshots/occupancy").shape()[1] / 2;
  return static_cast<double>(half_cells) * result.Scalar<double>("cell_m");
}

}  // namespace cairn::datasets
