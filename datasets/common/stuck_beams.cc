#include "datasets/common/stuck_beams.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "schema/kinds/log.h"

namespace cairn::datasets {
namespace {

constexpr std::size_t kLeastOfBeam = 100, kMostScans = 1000;  // that are looked at
constexpr double kStuck_m = 0.01, kStuckShare = 0.95, kMoving = 0.5;

// The echoes of each beam; of a long log those of some scans.
std::vector<std::vector<double>> EchoesOf(const Walked<double>& range_m, std::size_t beams, double reach_m) {
  std::vector<std::vector<double>> readings(beams);
  const std::size_t scans = beams == 0 ? 0 : range_m.size() / beams,
                    every = std::max<std::size_t>(1, scans / kMostScans);
  for (std::size_t scan = 0; scan < scans; scan += every) {
    for (std::size_t b = 0; b < beams; ++b) {
      const double range = range_m[scan * beams + b];
      if (kinds::IsEcho(range, reach_m)) readings[b].push_back(range);
    }
  }
  return readings;
}

// Their median, and the share of them that are about it.
struct Middle {
  double range_m = 0, share = 0;
};

Middle MiddleOfBeam(std::vector<double> some) {
  const auto middle = some.begin() + static_cast<std::ptrdiff_t>(some.size() / 2);
  std::ranges::nth_element(some, middle);
  const double at = *middle;
  const auto same =
      std::ranges::count_if(some, [&](double range) { return std::abs(range - at) <= kStuck_m; });
  return {at, static_cast<double>(same) / static_cast<double>(some.size())};
}

std::string Named(const StuckBeam& stuck, const kinds::Log::RangeSensor& sensor) {
  return fmt::format("{} (which points {:.0f} degrees from ahead; {:.4g} m)", stuck.beam,
                     sensor.beam_heading_rad[stuck.beam] * 180 / std::numbers::pi, stuck.range_m);
}

std::string WarningOf(const std::string& robot, const kinds::Log::RangeSensor& sensor,
                      const std::vector<StuckBeam>& stuck) {
  constexpr std::size_t kNamed = 3;
  std::string names;
  for (std::size_t k = 0; k < std::min(stuck.size(), kNamed); ++k)
    names += (k == 0 ? "" : ", ") + Named(stuck[k], sensor);
  if (stuck.size() > kNamed) names += fmt::format(" and {} more", stuck.size() - kNamed);
  return fmt::format(
      "robot '{}', its {}: {} of {} beams always measure the same, while the others change: {}. Are they "
      "broken, or do they see the robot itself? What they say is taken for a wall beside all of the robot's "
      "way: write NaN there",
      robot, sensor.sensor, stuck.size(), sensor.beam_heading_rad.size(), names);
}

}  // namespace

std::vector<StuckBeam> FindStuckBeams(const Walked<double>& range_m, std::size_t beams, double reach_m) {
  std::vector<StuckBeam> stuck;
  std::size_t told = 0, moving = 0;
  std::vector<std::vector<double>> readings = EchoesOf(range_m, beams, reach_m);
  for (std::size_t b = 0; b < beams; ++b) {
    if (readings[b].size() < kLeastOfBeam) continue;
    const Middle middle = MiddleOfBeam(std::move(readings[b]));
    ++told;
    moving += middle.share <= kMoving ? 1 : 0;
    if (middle.share >= kStuckShare) stuck.push_back({b, middle.range_m});
  }
  constexpr std::size_t kLeastMoving = 2;
  if (moving < kLeastMoving || 2 * moving < told - stuck.size()) return {};
  return stuck;
}

std::vector<std::string> StuckBeamsOf(const Blob& log) {
  const auto parts = Read<kinds::Log>(log);
  const std::vector<std::string>& robots = parts.robots.OrNone();
  std::vector<std::string> texts;
  for (std::size_t n = 0; n < std::min(robots.size(), parts.robot.size()); ++n) {
    for (const kinds::Log::RangeSensor& sensor : parts.robot[n].sensors) {
      const std::size_t beams = sensor.beam_heading_rad.OrNone().size();
      if (beams == 0 || !sensor.range_m || sensor.range_m.size() % beams != 0) continue;
      const std::vector<StuckBeam> stuck = FindStuckBeams(
          sensor.range_m.array(), beams, sensor.max_range_m.Or(std::numeric_limits<double>::infinity()));
      if (!stuck.empty()) texts.push_back(WarningOf(robots[n], sensor, stuck));
    }
  }
  return texts;
}

}  // namespace cairn::datasets
