#include "schema/kinds/odometry_holes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>

#include "schema/geometry.h"
#include "schema/kinds/log.h"

namespace cairn {
namespace {

constexpr double kUsualTimes = 20;  // as long as the middle one of all pauses
constexpr double kLeast_s = 2;
constexpr double kLeastTravel_m = 0.05, kLeastTurn_rad = 0.05;

struct Hole {
  double begin_s = 0, length_s = 0, usual_s = 0, missing_m = 0;
  std::ptrdiff_t observations = 0;
  std::size_t others = 0;  // shorter ones
};

// The pause between two rows from which on it is a hole; none: too few rows tell what is usual.
std::optional<double> UsualPause(std::span<const double> time_s) {
  constexpr std::size_t kFew = 20;
  std::vector<double> pauses;
  for (std::size_t i = 1; i < time_s.size(); ++i)
    if (time_s[i] > time_s[i - 1]) pauses.push_back(time_s[i] - time_s[i - 1]);
  if (pauses.size() < kFew) return std::nullopt;
  std::ranges::nth_element(pauses, pauses.begin() + static_cast<std::ptrdiff_t>(pauses.size() / 2));
  return pauses[pauses.size() / 2];
}

// How fast the robot went in the rows before row i and after it.
double SpeedAround(const kinds::Log::Odometry& odometry, std::size_t i) {
  constexpr std::size_t kRows = 10;
  const auto time_s = odometry.time_s.values(), forward_m = odometry.forward_m.values();
  const std::size_t first = i > kRows ? i - kRows : 1, last = std::min(i + kRows, time_s.size() - 1);
  double travelled_m = 0;
  for (std::size_t k = first; k <= last; ++k)
    if (k != i) travelled_m += std::abs(forward_m[k]);
  const double seconds = time_s[i - 1] - time_s[first - 1] + time_s[last] - time_s[i];
  return seconds > 0 ? travelled_m / seconds : 0;
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

// By the named ones of rows [begin, end): a landmark is seen at the end where it was at first, or elsewhere;
// or each time there are others.
Motion MotionIn(const kinds::Log::Observations& seen, std::size_t begin, std::size_t end) {
  if (!seen.landmark || !seen.range_m || !seen.bearing_rad) return Motion::kUnknown;
  if (std::min({seen.landmark.size(), seen.range_m.size(), seen.bearing_rad.size()}) < end)
    return Motion::kUnknown;
  Motion motion = Motion::kUnknown;
  bool others = false;
  for (std::size_t a = begin; a < end; ++a) {
    if (seen.landmark[a] < 0) return Motion::kUnknown;
    others |= seen.landmark[a] != seen.landmark[begin] && seen.time_s[a] != seen.time_s[begin];
    std::size_t last = end - 1;
    while (seen.landmark[last] != seen.landmark[a]) --last;
    if (seen.time_s[last] == seen.time_s[a]) continue;
    if (!SeenAlike(seen, a, last)) return Motion::kMoved;
    motion = Motion::kStood;
  }
  return motion == Motion::kUnknown && others ? Motion::kMoved : motion;
}

// Whether that of the row before row i and it, and what was observed meanwhile, make a hole.
std::optional<Hole> HoleBefore(const kinds::Log::Robot& robot, std::size_t i) {
  const kinds::Log::Odometry& odometry = robot.odometry;
  const auto observed_s = robot.observations.time_s.OrNone();
  const double from_s = odometry.time_s[i - 1], until_s = odometry.time_s[i];
  const auto first = std::ranges::upper_bound(observed_s, from_s) - observed_s.begin();
  const auto last = std::ranges::lower_bound(observed_s, until_s) - observed_s.begin();
  if (last <= first) return std::nullopt;
  const Motion motion =
      MotionIn(robot.observations, static_cast<std::size_t>(first), static_cast<std::size_t>(last));
  constexpr double kMuch_m = 0.5;
  const double said_m = std::abs(odometry.forward_m[i]);
  const double expected_m = SpeedAround(odometry, i) * (until_s - from_s);
  Hole hole{.begin_s = from_s, .length_s = until_s - from_s, .observations = last - first};
  if (expected_m >= kMuch_m && 2 * said_m < expected_m) hole.missing_m = expected_m - said_m;
  if (motion == Motion::kMoved && hole.missing_m > 0) return hole;
  if (motion == Motion::kStood && said_m < kMuch_m) return std::nullopt;
  if (said_m < kLeastTravel_m && std::abs(odometry.turn_rad[i]) < kLeastTurn_rad) return std::nullopt;
  return hole;
}

std::optional<Hole> LongestHole(const kinds::Log::Robot& robot) {
  const auto time_s = robot.odometry.time_s.OrNone();
  if (robot.odometry.turn_rad.OrNone().size() != time_s.size() ||
      robot.odometry.forward_m.OrNone().size() != time_s.size())
    return std::nullopt;
  if (!std::ranges::is_sorted(time_s) || !std::ranges::is_sorted(robot.observations.time_s.OrNone()))
    return std::nullopt;
  const std::optional<double> usual_s = UsualPause(time_s);
  if (!usual_s) return std::nullopt;
  std::optional<Hole> longest;
  std::size_t holes = 0;
  for (std::size_t i = 1; i < time_s.size(); ++i) {
    if (!(time_s[i] - time_s[i - 1] >= std::max(kLeast_s, kUsualTimes * *usual_s))) continue;
    const std::optional<Hole> hole = HoleBefore(robot, i);
    if (!hole) continue;
    ++holes;
    if (!longest || hole->length_s > longest->length_s) longest = hole;
  }
  if (!longest) return std::nullopt;
  longest->usual_s = *usual_s;
  longest->others = holes - 1;
  return longest;
}

// Seconds since 1970 would all look alike in four digits.
std::string Shown(double value) { return fmt::format("{:.{}g}", value, std::abs(value) < 1e5 ? 4 : 12); }

}  // namespace

std::vector<std::string> OdometryHolesOf(const Blob& log) {
  std::vector<std::string> texts;
  const auto parts = Read<kinds::Log>(log);
  for (std::size_t n = 0; n < parts.robots.OrNone().size(); ++n) {
    const auto hole = LongestHole(parts.robot[n]);
    if (!hole) continue;
    std::string text = fmt::format(
        "robot '{}': its odometry lacks {} s from {} s on (rows are {} s apart), in which it moved and "
        "observed {} times; ",
        parts.robots[n], Shown(hole->length_s), Shown(hole->begin_s), Shown(hole->usual_s),
        hole->observations);
    text += hole->missing_m > 0
                ? fmt::format("of what it travelled some {} m are missing, by its speed before and after",
                              Shown(std::ceil(hole->missing_m)))
                : "it is taken to have gone evenly";
    if (hole->others > 0) text += fmt::format("; and {} shorter such holes", hole->others);
    texts.push_back(text);
  }
  return texts;
}

}  // namespace cairn
