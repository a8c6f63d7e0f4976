#include "datasets/import/recorded/carmen_mount.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cairn::datasets {
namespace {

template <class Value>
double Median(const std::vector<Pose>& mounts, const Value& value) {
  std::vector<double> values;
  for (const Pose& mount : mounts) values.push_back(value(mount));
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

double StepOf(std::size_t beams) {
  constexpr double kSpan_deg = 180;
  switch (beams) {
    case 180:
    case 360:
      return kSpan_deg / static_cast<double>(beams);
    case 400:
    case 401:
      return 0.25;
    default:
      return beams > 1 ? kSpan_deg / static_cast<double>(beams - 1) : 1;
  }
}

}  // namespace

Pose RobotUnder(const Pose& laser, const Pose& mount) {
  const double heading = WrapAngle(laser.heading_rad - mount.heading_rad);
  const double c = std::cos(heading), s = std::sin(heading);
  return {laser.x_m - c * mount.x_m + s * mount.y_m, laser.y_m - s * mount.x_m - c * mount.y_m, heading};
}

Pose MedianMount(const std::vector<Pose>& mounts) {
  const double first = mounts.front().heading_rad;
  const double turn = Median(mounts, [&](const Pose& m) { return WrapAngle(m.heading_rad - first); });
  return {Median(mounts, [](const Pose& m) { return m.x_m; }),
          Median(mounts, [](const Pose& m) { return m.y_m; }), WrapAngle(first + turn)};
}

bool MovesApart(const std::vector<Pose>& mounts) {
  constexpr double kApart_m = 0.05, kApart_rad = 2 * std::numbers::pi / 180;
  if (mounts.empty()) return false;
  const Pose middle = MedianMount(mounts);
  return std::ranges::any_of(mounts, [&](const Pose& mount) {
    return DistanceM({mount.x_m, mount.y_m}, {middle.x_m, middle.y_m}) > kApart_m ||
           std::abs(WrapAngle(mount.heading_rad - middle.heading_rad)) > kApart_rad;
  });
}

bool AllAlike(const std::vector<Pose>& mounts) {
  return std::ranges::all_of(mounts,
                             [](const Pose& m) { return m.x_m == 0 && m.y_m == 0 && m.heading_rad == 0; });
}

BeamFan FanOf(std::size_t beams, std::optional<double> first_deg, std::optional<double> step_deg,
              std::optional<double> param_step_deg) {
  constexpr double kRight_deg = -90, kMostSpan_deg = 360;
  const double gaps = static_cast<double>(beams) - 1;
  const bool stated = param_step_deg && *param_step_deg > 0 && gaps * *param_step_deg <= kMostSpan_deg;
  BeamFan fan;
  fan.step_deg = step_deg.value_or(stated ? *param_step_deg : StepOf(beams));
  const bool half_circle = std::abs((gaps + 0.5) * fan.step_deg - 2 * -kRight_deg) < 2 * fan.step_deg;
  fan.first_deg = first_deg.value_or(half_circle ? kRight_deg : -gaps * fan.step_deg / 2);
  const bool usual =
      beams == 180 || beams == 181 || beams == 360 || beams == 361 || beams == 400 || beams == 401;
  fan.guessed = !step_deg && !stated && !usual;
  return fan;
}

}  // namespace cairn::datasets
