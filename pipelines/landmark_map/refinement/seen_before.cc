#include "pipelines/landmark_map/refinement/seen_before.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numeric>

#include "pipelines/common/odometry.h"
#include "pipelines/landmark_map/refinement/row_associations.h"
#include "schema/square.h"

namespace cairn::landmark_map {
namespace {

// A frame's pose in another: the robot's odometry in the map's, from what EM says of its first step.
struct Frame {
  double x_m, y_m, heading_rad;
  Point Of(double x, double y) const {
    return {x_m + std::cos(heading_rad) * x - std::sin(heading_rad) * y,
            y_m + std::sin(heading_rad) * x + std::cos(heading_rad) * y};
  }
};

Frame OdometryOnMap(const AssociatedPath& path, const OdometricPose& first) {
  const double turn = path.steps.odo_heading_rad[0] + path.correction_rad[0] - first.heading_rad;
  const Point moved = Frame{0, 0, turn}.Of(first.x_m, first.y_m);
  return {path.x_m[0] - moved.x_m, path.y_m[0] - moved.y_m, turn};
}

}  // namespace

void AddSeenBefore(const kinds::Log& log, const std::vector<AssociatedPath>& paths, double until_s,
                   std::vector<Landmark>* landmarks, std::vector<Associated>* associated) {
  constexpr double kLostHeading_rad = 0.1;
  std::map<int, Landmark> added;  // by name
  for (std::size_t r = 1; r < paths.size(); ++r) {
    const kinds::Log::Observations& seen = log.robot[r].observations;
    const auto identity = seen.landmark.values();
    const auto time = seen.time_s.values(), range = seen.range_m.values(),
               bearing = seen.bearing_rad.values();
    const Odometry odometry = Integrate(log.robot[r].odometry, log.robots[r]);
    const double first_s = paths[r].steps.time_s[0];
    const OdometricPose first = PoseAt(odometry, first_s);
    const Frame on_map = OdometryOnMap(paths[r], first);
    for (std::size_t i = 0; i < time.size() && time[i] < std::min(first_s, until_s); ++i) {
      if (identity[i] < 0 || LandmarkNamed(*landmarks, identity[i]) >= 0) continue;
      const OdometricPose at = PoseAt(odometry, time[i]);
      const bool contact = std::isnan(range[i]);
      const double ray = at.heading_rad + (contact ? 0.0 : bearing[i]), range_m = contact ? 0.0 : range[i];
      const Point place = on_map.Of(at.x_m + range_m * std::cos(ray), at.y_m + range_m * std::sin(ray));
      const double variance = Square(kLostHeading_rad * (first.path_m - at.path_m + range_m));
      Landmark& landmark = added.try_emplace(identity[i]).first->second;
      landmark = {place.x_m, place.y_m, {variance, 0, 0, variance}, identity[i], landmark.count + 1};
    }
  }
  if (added.empty()) return;
  const std::size_t before = landmarks->size();
  for (const auto& [name, landmark] : added) landmarks->push_back(landmark);
  std::vector<std::size_t> order(landmarks->size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t l) { return (*landmarks)[l].type; });
  std::vector<Landmark> sorted;
  std::vector<std::int32_t> now(before);
  for (const std::size_t l : order) {
    if (l < before) now[l] = static_cast<std::int32_t>(sorted.size());
    sorted.push_back((*landmarks)[l]);
  }
  *landmarks = std::move(sorted);
  for (Associated& of : *associated)
    for (std::int32_t& landmark : of.landmark)
      if (landmark >= 0) landmark = now[static_cast<std::size_t>(landmark)];
}

}  // namespace cairn::landmark_map
