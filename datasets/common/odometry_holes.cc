#include "datasets/common/odometry_holes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>

#include "datasets/common/array_text.h"
#include "schema/kinds/log.h"

namespace cairn::datasets {
namespace {

constexpr double kUsualTimes = 20;  // as long as the middle one of all pauses
constexpr double kLeast_s = 2;
constexpr double kLeastTravel_m = 0.05, kLeastTurn_rad = 0.05;

struct Hole {
  double begin_s = 0, length_s = 0, usual_s = 0;
  std::ptrdiff_t observations = 0;
  std::size_t others = 0;  // shorter ones
};

// The longest, of times in order.
std::optional<Hole> LongestHole(std::span<const double> time_s, std::span<const double> turn_rad,
                                std::span<const double> forward_m, std::span<const double> observed_s) {
  if (turn_rad.size() != time_s.size() || forward_m.size() != time_s.size()) return std::nullopt;
  if (!std::ranges::is_sorted(time_s) || !std::ranges::is_sorted(observed_s)) return std::nullopt;
  std::vector<double> pauses;
  for (std::size_t i = 1; i < time_s.size(); ++i)
    if (time_s[i] > time_s[i - 1]) pauses.push_back(time_s[i] - time_s[i - 1]);
  constexpr std::size_t kFew = 20;
  if (pauses.size() < kFew) return std::nullopt;
  std::ranges::nth_element(pauses, pauses.begin() + static_cast<std::ptrdiff_t>(pauses.size() / 2));
  const double usual_s = pauses[pauses.size() / 2], least_s = std::max(kLeast_s, kUsualTimes * usual_s);
  std::optional<Hole> longest;
  std::size_t holes = 0;
  for (std::size_t i = 1; i < time_s.size(); ++i) {
    const double length_s = time_s[i] - time_s[i - 1];
    if (!(length_s >= least_s)) continue;
    if (std::abs(forward_m[i]) < kLeastTravel_m && std::abs(turn_rad[i]) < kLeastTurn_rad) continue;
    const auto first = std::ranges::upper_bound(observed_s, time_s[i - 1]);
    const std::ptrdiff_t observations = std::ranges::lower_bound(observed_s, time_s[i]) - first;
    if (observations <= 0) continue;
    ++holes;
    if (!longest || length_s > longest->length_s)
      longest = Hole{time_s[i - 1], length_s, usual_s, observations, 0};
  }
  if (longest) longest->others = holes - 1;
  return longest;
}

}  // namespace

std::vector<std::string> OdometryHolesOf(const Blob& blob) {
  std::vector<std::string> texts;
  const auto log = Read<kinds::Log>(blob);
  for (std::size_t n = 0; n < log.robots.OrNone().size(); ++n) {
    const kinds::Log::Odometry& odometry = log.robot[n].odometry;
    const auto hole = LongestHole(odometry.time_s.OrNone(), odometry.turn_rad.OrNone(),
                                  odometry.forward_m.OrNone(), log.robot[n].observations.time_s.OrNone());
    if (!hole) continue;
    texts.push_back(
        "robot '" + log.robots[n] + "': its odometry lacks " + ShortNumber(hole->length_s) + " s from " +
        ShortNumber(hole->begin_s) + " s on (rows are " + ShortNumber(hole->usual_s) +
        " s apart), in which it moved and observed " + std::to_string(hole->observations) +
        " times; it is taken to have gone evenly" +
        (hole->others > 0 ? "; and " + std::to_string(hole->others) + " shorter such holes" : ""));
  }
  return texts;
}

}  // namespace cairn::datasets
