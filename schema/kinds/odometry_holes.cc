#include "schema/kinds/odometry_holes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>

#include "schema/geometry.h"
#include "schema/kinds/log.h"
#include "schema/middle.h"
#include "schema/walked.h"

namespace cairn {
namespace {

constexpr double kUsualTimes = 20;  // as long as the middle one of all pauses
constexpr double kLeast_s = 2;
constexpr double kLeastTravel_m = 0.05, kLeastTurn_rad = 0.05;

// The pause between two rows from which on it is a hole; none: too few rows tell what is usual.
std::optional<double> UsualPause(const Walked<double>& time_s) {
  constexpr std::size_t kFew = 20;
  return MiddlePause(time_s, kFew);
}

// How fast the robot went in the rows before row i, and in those after it.
struct Speeds {
  double before_mps = 0, after_mps = 0;
};

Speeds SpeedsAround(const kinds::Log::Odometry& odometry, std::size_t i) {
  constexpr std::size_t kRows = 10;
  const auto time_s = odometry.time_s.values(), forward_m = odometry.forward_m.values();
  const std::size_t first = i > kRows ? i - kRows : 1, last = std::min(i + kRows, time_s.size() - 1);
  double before_m = 0, after_m = 0;
  for (std::size_t k = first; k < i; ++k) before_m += std::abs(forward_m[k]);
  for (std::size_t k = i + 1; k <= last; ++k) after_m += std::abs(forward_m[k]);
  const double before_s = time_s[i - 1] - time_s[first - 1], after_s = time_s[last] - time_s[i];
  return {before_s > 0 ? before_m / before_s : 0, after_s > 0 ? after_m / after_s : 0};
}

// What observations say of the robot that made them.
enum class Motion { kUnknown, kStood, kMoved };

// Of one landmark, at two times.
bool SeenAlike(const kinds::Log::Observations& seen, std::size_t a, std::size_t b) {
  constexpr double kSame_m = 0.5, kSame_rad = 0.2;
  if (std::isnan(seen.range_m[a]) || std::isnan(seen.range_m[b]))
    return std::isnan(seen.range_m[a]) && std::isnan(seen.range_m[b]);
  return std::abs(seen.range_m[a] - seen.range_m[b]) < kSame_m &&
         std::abs(WrapAngle(seen.bearing_rad[a] - seen.bearing_rad[b])) < kSame_rad;
}

// By the named ones of rows [begin, end): landmarks are seen at the end where they were before, or more than
// a quarter elsewhere, as of thousands some few err by much; or each time there are others.
Motion MotionIn(const kinds::Log::Observations& seen, std::size_t begin, std::size_t end) {
  if (!seen.landmark || !seen.range_m || !seen.bearing_rad) return Motion::kUnknown;
  if (std::min({seen.landmark.size(), seen.range_m.size(), seen.bearing_rad.size()}) < end)
    return Motion::kUnknown;
  std::size_t again = 0, elsewhere = 0;
  bool others = false;
  for (std::size_t a = begin; a < end; ++a) {
    if (seen.landmark[a] < 0) return Motion::kUnknown;
    others |= seen.landmark[a] != seen.landmark[begin] && seen.time_s[a] != seen.time_s[begin];
    std::size_t last = end - 1;
    while (seen.landmark[last] != seen.landmark[a]) --last;
    if (seen.time_s[last] == seen.time_s[a]) continue;
    ++again;
    elsewhere += !SeenAlike(seen, a, last);
  }
  if (again == 0) return others ? Motion::kMoved : Motion::kUnknown;
  return 4 * elsewhere > again ? Motion::kMoved : Motion::kStood;
}

// The rows [first, second) of one image: all of one time.
using Image = std::pair<std::size_t, std::size_t>;

bool HasLike(const kinds::Log::Observations& seen, std::size_t a, const Image& image, double travelled_m) {
  constexpr double kSame_m = 0.5, kSame_rad = 0.2, kNear_m = 1;
  for (std::size_t b = image.first; b < image.second; ++b) {
    if (seen.landmark[a] != seen.landmark[b]) continue;
    if (std::abs(seen.range_m[a] - seen.range_m[b]) < kSame_m + travelled_m &&
        std::abs(WrapAngle(seen.bearing_rad[a] - seen.bearing_rad[b])) <
            kSame_rad + travelled_m / std::max(kNear_m, seen.range_m[a]))
      return true;
  }
  return false;
}

// Whether the first image after a time in which nothing was observed shows other things than the last one
// before: less than half of either is in both. Not where either is much farther away than observations are
// apart.
bool SeesOtherwiseAfter(const kinds::Log::Observations& seen, const OdometryHole& hole,
                        const Speeds& speeds) {
  constexpr double kNearTimes = 3;
  if (!seen.landmark || !seen.range_m || !seen.bearing_rad) return false;
  const auto time_s = seen.time_s.OrNone();
  if (std::min({seen.landmark.size(), seen.range_m.size(), seen.bearing_rad.size()}) < time_s.size())
    return false;
  const std::optional<double> usual_s = UsualPause(time_s);
  const auto next = static_cast<std::size_t>(std::ranges::upper_bound(time_s, hole.begin_s) - time_s.begin());
  if (!usual_s || next == 0 || next == time_s.size()) return false;
  const double before_s = hole.begin_s - time_s[next - 1];
  const double after_s = time_s[next] - hole.begin_s - hole.length_s;
  if (std::max(before_s, after_s) > kNearTimes * *usual_s) return false;
  Image before{next - 1, next}, after{next, next + 1};
  while (before.first > 0 && time_s[before.first - 1] == time_s[next - 1]) --before.first;
  while (after.second < time_s.size() && time_s[after.second] == time_s[next]) ++after.second;
  for (std::size_t i = before.first; i < after.second; ++i)
    if (std::isnan(seen.range_m[i])) return false;
  const double travelled_m = speeds.before_mps * before_s + speeds.after_mps * after_s;
  std::size_t alike = 0;
  for (std::size_t a = before.first; a < before.second; ++a) alike += HasLike(seen, a, after, travelled_m);
  return 2 * alike < std::min(before.second - before.first, after.second - after.first);
}

// Whether that of the row before row i and it, and what was observed meanwhile, make a hole.
std::optional<OdometryHole> HoleBefore(const kinds::Log::Robot& robot, std::size_t i) {
  constexpr double kMuch_m = 0.5;
  const kinds::Log::Odometry& odometry = robot.odometry;
  const auto observed_s = robot.observations.time_s.OrNone();
  const double from_s = odometry.time_s[i - 1], until_s = odometry.time_s[i];
  const auto first = std::ranges::upper_bound(observed_s, from_s) - observed_s.begin();
  const auto last = std::ranges::lower_bound(observed_s, until_s) - observed_s.begin();
  const double said_m = std::abs(odometry.forward_m[i]);
  const Speeds speeds = SpeedsAround(odometry, i);
  OdometryHole hole{.begin_s = from_s, .length_s = until_s - from_s, .observations = last - first};
  const double expected_m = (speeds.before_mps + speeds.after_mps) / 2 * hole.length_s;
  if (expected_m >= kMuch_m && 2 * said_m < expected_m) hole.missing_m = expected_m - said_m;
  if (hole.observations == 0) {
    // Who comes to rest, and says nothing until it goes on, was slow before, or sees then what it saw.
    const bool went_on = std::min(speeds.before_mps, speeds.after_mps) * hole.length_s >= kMuch_m;
    if (went_on && hole.missing_m > 0 && SeesOtherwiseAfter(robot.observations, hole, speeds)) return hole;
    return std::nullopt;
  }
  const Motion motion =
      MotionIn(robot.observations, static_cast<std::size_t>(first), static_cast<std::size_t>(last));
  if (motion == Motion::kMoved && hole.missing_m > 0) return hole;
  if (motion == Motion::kStood && said_m < kMuch_m) return std::nullopt;
  if (said_m < kLeastTravel_m && std::abs(odometry.turn_rad[i]) < kLeastTurn_rad) return std::nullopt;
  return hole;
}

std::vector<OdometryHole> HolesOf(const kinds::Log::Robot& robot) {
  if (!robot.odometry.time_s) return {};
  const Walked<double> time_s = robot.odometry.time_s.array();
  if (robot.odometry.turn_rad.OrNone().size() != time_s.size() ||
      robot.odometry.forward_m.OrNone().size() != time_s.size())
    return {};
  if (!std::ranges::is_sorted(time_s) || !std::ranges::is_sorted(robot.observations.time_s.OrNone()))
    return {};
  const std::optional<double> usual_s = UsualPause(time_s);
  if (!usual_s) return {};
  std::vector<OdometryHole> holes;
  for (std::size_t i = 1; i < time_s.size(); ++i) {
    if (!(time_s[i] - time_s[i - 1] >= std::max(kLeast_s, kUsualTimes * *usual_s))) continue;
    std::optional<OdometryHole> hole = HoleBefore(robot, i);
    if (!hole) continue;
    hole->usual_s = *usual_s;
    holes.push_back(*hole);
  }
  return holes;
}

// Seconds since 1970 would all look alike in four digits.
std::string Shown(double value) { return fmt::format("{:.{}g}", value, std::abs(value) < 1e5 ? 4 : 12); }

}  // namespace

std::vector<OdometryHole> FindOdometryHoles(const Blob& log) {
  std::vector<OdometryHole> all;
  const auto parts = Read<kinds::Log>(log);
  for (std::size_t n = 0; n < parts.robots.OrNone().size(); ++n) {
    for (OdometryHole hole : HolesOf(parts.robot[n])) {
      hole.robot = static_cast<std::int32_t>(n);
      all.push_back(hole);
    }
  }
  return all;
}

std::vector<std::string> OdometryHolesOf(const Blob& log) {
  std::vector<std::string> texts;
  const std::vector<OdometryHole> all = FindOdometryHoles(log);
  const Texts robots = Texts::In(log, "robots");
  for (auto from = all.begin(); from != all.end();) {
    const auto to =
        std::find_if(from, all.end(), [&](const auto& hole) { return hole.robot != from->robot; });
    const OdometryHole& hole =
        *std::max_element(from, to, [](const auto& a, const auto& b) { return a.length_s < b.length_s; });
    const char* what = hole.observations > 0 ? "odometry" : "log";
    std::string text =
        fmt::format("robot '{}': its {} lacks {} s from {} s on (rows are {} s apart), in which it ",
                    robots[static_cast<std::size_t>(hole.robot)], what, Shown(hole.length_s),
                    Shown(hole.begin_s), Shown(hole.usual_s));
    text += hole.observations > 0
                ? fmt::format("moved and observed {} times; ", hole.observations)
                : std::string("moved, for it sees other things after (was the recorder paused?); ");
    text += hole.missing_m > 0
                ? fmt::format("of what it travelled some {} m are missing, by its speed before and after",
                              Shown(std::ceil(hole.missing_m)))
                : "it is taken to have gone evenly";
    if (to - from > 1) text += fmt::format("; and {} shorter such holes", to - from - 1);
    texts.push_back(text);
    from = to;
  }
  return texts;
}

}  // namespace cairn
