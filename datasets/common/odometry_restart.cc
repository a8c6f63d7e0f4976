#include "datasets/common/odometry_restart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "schema/geometry.h"
#include "schema/middle.h"

namespace cairn::datasets {
namespace {

constexpr std::size_t kFewRows = 20;
constexpr double kLeastJump_m = 1;
constexpr double kStands_mps = 0.02, kFast_mps = 1.5;
// What a stalled recorder catches up with is no more than was driven meanwhile.
constexpr double kStall_s = 2;

struct OdometryTrack {
  const Walked<double>&time_s, &x_m, &y_m, &heading_rad;

  double Went(std::size_t i) const { return std::hypot(x_m[i] - x_m[i - 1], y_m[i] - y_m[i - 1]); }
  double Took(std::size_t i) const { return time_s[i] - time_s[i - 1]; }
  bool IsAt(std::size_t i, double x, double y, double heading) const {
    constexpr double kSame_m = 0.05, kSame_rad = 0.05;
    return std::hypot(x_m[i] - x, y_m[i] - y) < kSame_m &&
           std::abs(WrapAngle(heading_rad[i] - heading)) < kSame_rad;
  }
  bool IsAtBeginning(std::size_t i) const {
    return IsAt(i, x_m[0], y_m[0], heading_rad[0]) || IsAt(i, 0, 0, 0);
  }
  // Between rows of its own kind, or beside one that takes it back, a row is no jump.
  bool IsAlone(std::size_t i) const {
    constexpr double kTimes = 5;
    for (const std::size_t k : {i - 1, i + 1})
      if (k > 0 && k < time_s.size() && kTimes * Went(k) > Went(i)) return false;
    return i + 1 < time_s.size();
  }
};

}  // namespace

std::optional<UnitDoubt> DoubtRestart(const Walked<double>& time_s, const Walked<double>& x_m,
                                      const Walked<double>& y_m, const Walked<double>& heading_rad) {
  constexpr double kTimesAsFast = 5, kUsualPauses = 20;
  const std::size_t rows = time_s.size();
  if (std::min({x_m.size(), y_m.size(), heading_rad.size()}) < rows) return std::nullopt;
  const OdometryTrack track{time_s, x_m, y_m, heading_rad};
  const std::optional<double> pause_s = MiddlePause(time_s, kFewRows);
  const std::optional<double> usual_mps = MiddleOf(
      [&](const auto& take) {
        for (std::size_t i = 1; i < rows; ++i)
          if (track.Went(i) > kStands_mps * track.Took(i)) take(track.Went(i) / track.Took(i));
      },
      kFewRows);
  if (!pause_s || !usual_mps) return std::nullopt;
  const double hole_s = std::max(kStall_s, kUsualPauses * *pause_s);
  for (std::size_t i = 1; i < rows; ++i) {
    const double went_m = track.Went(i), took_s = track.Took(i);
    if (!(went_m >= kLeastJump_m) || !track.IsAlone(i)) continue;
    const bool back = track.IsAtBeginning(i);
    const double fast_mps = kTimesAsFast * *usual_mps, shortest_s = std::max(took_s, 2 * *pause_s);
    const bool jumps = back ? took_s >= hole_s || went_m > fast_mps * shortest_s
                            : went_m > std::max(fast_mps, kFast_mps) * std::max(shortest_s, kStall_s);
    if (!jumps) continue;
    return UnitDoubt{
        i, time_s[i],
        fmt::format("odometry goes {:.3g} m within {:.3g} s, {}: was its driver started anew, or the robot "
                    "carried? Where it went meanwhile nobody knows: let a log end before this row, and "
                    "another one, or another robot of the same log, begin with it",
                    went_m, took_s,
                    back ? "to where it began" : fmt::format("where {:.3g} m/s is usual", *usual_mps))};
  }
  return std::nullopt;
}

}  // namespace cairn::datasets
