#include "datasets/common/range_doubts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cairn::datasets {
namespace {

constexpr double kNear = 0.95;  // of the largest

// Which one more than half of the readings near the largest are, if any is.
double MajorityFrom(const Walked<double>& range_m, double least_m) {
  double candidate_m = 0;
  std::size_t ahead = 0;
  for (const double range : range_m) {
    if (!(range >= least_m)) continue;
    if (ahead == 0) candidate_m = range;
    ahead = range == candidate_m ? ahead + 1 : ahead - 1;
  }
  return candidate_m;
}

bool HasReadings(const kinds::Log::RangeSensor& sensor) {
  const std::size_t beams = sensor.beam_heading_rad.OrNone().size();
  return beams > 0 && sensor.range_m && sensor.max_range_m && sensor.max_range_m.size() == 1 &&
         sensor.range_m.size() % beams == 0;
}

std::string ShareOf(double share) { return fmt::format("{:.2g}%", 100 * share); }

}  // namespace

std::optional<ConstantReading> FindConstantReading(const Walked<double>& range_m, std::size_t beams) {
  constexpr std::size_t kFew = 1000, kTimesOthers = 4;
  constexpr double kShare = 0.05, kShareOfBeams = 0.25;
  double largest_m = 0;
  for (const double range : range_m) largest_m = std::max(largest_m, std::isnan(range) ? 0 : range);
  if (largest_m == 0) return std::nullopt;
  const double least_m = kNear * largest_m, found_m = MajorityFrom(range_m, least_m);
  std::size_t all = 0, same = 0, about_as_large = 0;
  std::vector<bool> by_beam(beams, false);
  for (std::size_t i = 0; i < range_m.size(); ++i) {
    const double range = range_m[i];
    all += std::isnan(range) ? 0 : 1;
    if (!(range >= least_m)) continue;
    if (range == found_m) {
      ++same;
      by_beam[i % beams] = true;
    } else {
      ++about_as_large;
    }
  }
  const double share = static_cast<double>(same) / static_cast<double>(all);
  const auto of_beams = static_cast<double>(std::ranges::count(by_beam, true));
  const bool is_one = all >= kFew && same < all && share > kShare && same >= kTimesOthers * about_as_large &&
                      of_beams >= kShareOfBeams * static_cast<double>(beams) &&
                      of_beams >= std::min<double>(static_cast<double>(beams), 2);
  return is_one ? std::optional(ConstantReading{found_m, share}) : std::nullopt;
}

std::vector<std::string> ConstantReadingsOf(const Blob& log) {
  const auto parts = Read<kinds::Log>(log);
  const std::vector<std::string>& robots = parts.robots.OrNone();
  std::vector<std::string> texts;
  for (std::size_t n = 0; n < std::min(robots.size(), parts.robot.size()); ++n) {
    for (const kinds::Log::RangeSensor& sensor : parts.robot[n].sensors) {
      if (!HasReadings(sensor)) continue;
      const auto found = FindConstantReading(sensor.range_m.array(), sensor.beam_heading_rad.size());
      const double reach_m = sensor.max_range_m[0];
      if (!found || !kinds::IsEcho(found->range_m, reach_m)) continue;
      texts.push_back(fmt::format(
          "robot '{0}', its {1}: {2} of its readings are exactly {3:.6g} m, below its reach, which is stated "
          "as {4:.6g} m, and hardly one is larger: is that what its driver writes where nothing came back? "
          "It is taken for a wall. Then {3:.6g} m is its reach (`cairn import carmen "
          "--{5}-max-range-m={3:.6g}`; of a log of another program robot/{6}/{1}/max_range_m), or NaN "
          "belongs there",
          robots[n], sensor.sensor, ShareOf(found->share), found->range_m, reach_m,
          sensor.sensor == "sonar" ? "sonar" : "laser", n));
    }
  }
  return texts;
}

std::vector<std::string> ZeroReadingsOf(const kinds::Log& log) {
  std::vector<std::string> texts;
  const std::vector<std::string>& robots = log.robots.OrNone();
  for (std::size_t n = 0; n < std::min(robots.size(), log.robot.size()); ++n) {
    for (const kinds::Log::RangeSensor& sensor : log.robot[n].sensors) {
      if (!sensor.range_m) continue;
      const Walked<double> range_m = sensor.range_m.array();
      const auto zeros = std::ranges::count(range_m, 0.0);
      constexpr double kFewZeros = 1e-3;
      if (static_cast<double>(zeros) <= kFewZeros * static_cast<double>(range_m.size())) continue;
      texts.push_back(
          fmt::format("robot '{}', its {}: {} of its {} readings are 0 m ({}), which is taken for a wall at "
                      "the sensor: write NaN where nothing came back",
                      robots[n], sensor.sensor, zeros, range_m.size(),
                      ShareOf(static_cast<double>(zeros) / static_cast<double>(range_m.size()))));
    }
  }
  return texts;
}

}  // namespace cairn::datasets
