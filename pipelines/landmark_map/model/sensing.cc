#include "pipelines/landmark_map/model/sensing.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

namespace cairn::landmark_map {
namespace {

// A missed contact detection doubles a distance: the median does not mind.
void AppendDistancesBetween(const kinds::Log::Robot& robot, std::vector<double>* distances) {
  const std::span<const double> end = robot.odometry.time_s, forward = robot.odometry.forward_m;
  std::size_t control = 0;
  double travelled = 0.0;
  bool first = true;
  for (const double time : robot.observations.time_s) {
    for (; control < end.size() && end[control] <= time; ++control) {
      travelled += std::abs(forward[control]);
    }
    if (!first) distances->push_back(travelled);
    first = false;
    travelled = 0.0;
  }
}

// So much of the values is below.
double Quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
  std::ranges::nth_element(values, at);
  return *at;
}
double Median(std::vector<double> values) { return Quantile(std::move(values), 0.5); }

// From each observation to the nearest other one of its image, or `farthest_m`. More are in no image.
constexpr std::size_t kMostInImage = 256;
void AppendDistancesInImages(const kinds::Log::Robot& robot, double farthest_m,
                             std::vector<double>* distances) {
  const auto& seen = robot.observations;
  for (std::size_t begin = 0, end = 0; begin < seen.time_s.size(); begin = end) {
    while (end < seen.time_s.size() && end - begin < kMostInImage && seen.time_s[end] == seen.time_s[begin])
      ++end;
    for (std::size_t i = begin; i < end; ++i) {
      double nearest_m = farthest_m;
      for (std::size_t j = begin; j < end; ++j) {
        if (j == i) continue;
        const double turn_rad = seen.bearing_rad[i] - seen.bearing_rad[j];
        const double along_m = seen.range_m[i] * std::cos(turn_rad) - seen.range_m[j];
        const double distance_m = std::hypot(along_m, seen.range_m[i] * std::sin(turn_rad));
        if (distance_m < nearest_m) nearest_m = distance_m;  // of contact detections it is not a number
      }
      distances->push_back(nearest_m);
    }
  }
}

}  // namespace

Sensing LookAt(const kinds::Log& log) {
  Sensing sensing;
  std::vector<double> between, apart;
  for (const kinds::Log::Robot& robot : log.robot) {
    for (const std::int32_t landmark : robot.observations.landmark)
      sensing.identified += landmark >= 0 ? 1 : 0;
    AppendDistancesBetween(robot, &between);
    for (const double range : robot.observations.range_m) {
      ++sensing.observations;
      if (std::isnan(range)) continue;
      ++sensing.ranged;
      sensing.max_range_m = std::max(sensing.max_range_m, range);
      sensing.mean_range_m += (range - sensing.mean_range_m) / static_cast<double>(sensing.ranged);
    }
  }
  sensing.between_m = Median(std::move(between));
  for (const kinds::Log::Robot& robot : log.robot)
    AppendDistancesInImages(robot, sensing.max_range_m, &apart);
  sensing.apart_m = Quantile(std::move(apart), 0.05);
  return sensing;
}

DistancesBetween MeasureDistancesBetween(const kinds::Log::Robot& robot) {
  std::vector<double> between;
  AppendDistancesBetween(robot, &between);
  if (between.empty()) return {};
  const double median_m = Median(between);
  std::ranges::sort(between);
  const std::size_t tenth = between.size() / 10;
  const double spread_m = between[between.size() - 1 - tenth] - between[tenth];
  return {median_m, median_m > 0 ? spread_m / median_m : 0};
}

ObservationWidths ObservationNoise::At(double x_m, double y_m) const {
  constexpr double kLeast_m = 1e-3;  // nothing is more exact, not even what is seen at arm's length
  const double distance_m = std::hypot(x_m, y_m);
  if (distance_m == 0.0) return {std::max(kLeast_m, contact_m), std::max(kLeast_m, contact_m)};
  return {std::max(kLeast_m, range_m), std::max(kLeast_m, bearing_rad * distance_m)};
}

}  // namespace cairn::landmark_map
