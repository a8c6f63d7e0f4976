#include "pipelines/landmark_map/refinement/seen_beside.h"

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

// A frame's pose in another: the robot's odometry in the map's, from what EM says of a step.
struct Frame {
  double x_m, y_m, heading_rad;
  Point Of(double x, double y) const {
    return {x_m + std::cos(heading_rad) * x - std::sin(heading_rad) * y,
            y_m + std::sin(heading_rad) * x + std::cos(heading_rad) * y};
  }
};

Frame OdometryOnMap(const AssociatedPath& path, std::size_t step, const OdometricPose& at) {
  const double turn = path.steps.odo_heading_rad[step] + path.correction_rad[step] - at.heading_rad;
  const Point moved = Frame{0, 0, turn}.Of(at.x_m, at.y_m);
  return {path.x_m[step] - moved.x_m, path.y_m[step] - moved.y_m, turn};
}

}  // namespace

void AddSeenBeside(const kinds::Log& log, const std::vector<AssociatedPath>& paths, double until_s,
                   std::vector<Landmark>* landmarks, std::vector<Associated>* associated) {
  constexpr double kLostHeading_rad = 0.1;
  std::map<int, Landmark> added;  // by name
  for (std::size_t r = 0; r < paths.size(); ++r) {
    const kinds::Log::Observations& seen = log.robot[r].observations;
    const auto identity = seen.landmark.values();
    const auto time = seen.time_s.values(), range = seen.range_m.values(),
               bearing = seen.bearing_rad.values();
    const std::vector<double>& step_s = paths[r].steps.time_s;
    const Odometry odometry = Integrate(log.robot[r].odometry, log.robots[r]);
    for (std::size_t i = 0; i < time.size() && time[i] < until_s; ++i) {
      if (identity[i] < 0 || LandmarkNamed(*landmarks, identity[i]) >= 0) continue;
      const auto after = std::ranges::upper_bound(step_s, time[i]) - step_s.begin();
      const auto step = static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - 1, 0));
      const OdometricPose at = PoseAt(odometry, time[i]), of_step = PoseAt(odometry, step_s[step]);
      const bool contact = std::isnan(range[i]);
      const double ray = at.heading_rad + (contact ? 0.0 : bearing[i]), range_m = contact ? 0.0 : range[i];
      const Point place = OdometryOnMap(paths[r], step, of_step)
                              .Of(at.x_m + range_m * std::cos(ray), at.y_m + range_m * std::sin(ray));
      const double variance = Square(kLostHeading_rad * (std::abs(of_step.path_m - at.path_m) + range_m));
      const auto [found, is_new] = added.try_emplace(identity[i]);
      Landmark& landmark = found->second;
      const double count = landmark.count + 1;
      if (is_new || variance <= landmark.covariance_m2[0])
        landmark = {place.x_m, place.y_m, {variance, 0, 0, variance}, identity[i], count};
      landmark.count = count;
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
  for (std::size_t r = 0; r < paths.size(); ++r) {
    const auto identity = log.robot[r].observations.landmark.values();
    for (std::size_t i = 0; i < identity.size(); ++i) {
      if (paths[r].steps.row_observation[i] < 0 || !added.contains(identity[i])) continue;
      const auto at = static_cast<std::size_t>(paths[r].steps.row_observation[i]);
      (*associated)[r].landmark[at] = LandmarkNamed(*landmarks, identity[i]);
      (*associated)[r].probability[at] = 1.0;
    }
  }
}

}  // namespace cairn::landmark_map
