#include "pipelines/landmark_map/model/sensing.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace cairn::landmark_map {
namespace {

// A missed press doubles a way: the median does not mind.
void AppendWaysBetween(const Blob& robot, std::vector<double>* ways) {
  const auto end = robot.Get<double>("odometry/time_s"), forward = robot.Get<double>("odometry/forward_m");
  std::size_t control = 0;
  double way = 0.0;
  bool first = true;
  for (const double time : robot.Get<double>("observations/time_s")) {
    for (; control < end.size() && control < forward.size() && end[control] <= time; ++control) {
      way += std::abs(forward[control]);
    }
    if (!first) ways->push_back(way);
    first = false;
    way = 0.0;
  }
}

double Median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace

Sensing LookAt(const Blob& log, std::size_t robots) {
  Sensing sensing;
  std::vector<double> between;
  for (std::size_t r = 0; r < robots; ++r) {
    const Blob robot = log.Sub("robot/" + std::to_string(r) + "/");
    for (const std::int32_t landmark : robot.Get<std::int32_t>("observations/landmark")) {
      sensing.identified += landmark >= 0 ? 1 : 0;
    }
    AppendWaysBetween(robot, &between);
    for (const double range : robot.Get<double>("observations/range_m")) {
      ++sensing.observations;
      if (std::isnan(range)) continue;
      ++sensing.ranged;
      sensing.max_range_m = std::max(sensing.max_range_m, range);
      sensing.mean_range_m += (range - sensing.mean_range_m) / static_cast<double>(sensing.ranged);
    }
  }
  sensing.between_m = Median(std::move(between));
  return sensing;
}

double MedianWayBetween(const Blob& robot) {
  std::vector<double> between;
  AppendWaysBetween(robot, &between);
  return Median(std::move(between));
}

}  // namespace cairn::landmark_map
