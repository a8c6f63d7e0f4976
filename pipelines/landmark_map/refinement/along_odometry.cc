#include "pipelines/landmark_map/refinement/along_odometry.h"

#include <algorithm>
#include <limits>

#include "pipelines/landmark_map/landmarks/image_landmarks.h"
#include "pipelines/landmark_map/refinement/all_rows.h"
#include "schema/kinds/landmark_map.h"

namespace cairn::landmark_map {

namespace {

bool ExplainsLittle(const FittedMap& map) {
  constexpr double kMany = 0.2;
  if (!map.refined.refused.empty()) return map.refined.refused == kinds::kOdometryWrongByHalf;
  double rows = 0;
  for (const RowAssociations& robot : map.rows) rows += static_cast<double>(robot.landmark.size());
  return static_cast<double>(RowsOfNone(map.rows)) > kMany * rows;
}

}  // namespace

FittedMap LaidAlongOdometry(const kinds::Log& log, const std::vector<RobotSteps>& steps,
                            const Settings& settings) {
  FittedMap map;
  std::vector<ImageObservations> images;
  for (std::size_t r = 0; r < steps.size(); ++r) {
    const std::size_t seen = steps[r].observations.size();
    map.paths.push_back({steps[r],
                         {0.0, settings.noise.heading_walk_rad_per_sqrt_m, settings.noise.turn_ratio},
                         steps[r].odo_x_m,
                         steps[r].odo_y_m,
                         std::vector<double>(steps[r].odo_x_m.size(), 0.0),
                         {std::vector<std::int32_t>(seen, -1), std::vector<double>(seen, 0.0)}});
    const AssociatedPath& path = map.paths.back();
    AppendImages(path.steps, settings.map.types, r, path.x_m, path.y_m, path.correction_rad, {}, &images);
  }
  const ImageLandmarks found =
      FindImageLandmarks(images, {settings.in_image_m, settings.map.grid.cell_m, settings.map.types});
  for (std::size_t i = 0; i < images.size(); ++i) {
    Associated& of = map.paths[images[i].robot].associated;
    for (std::size_t k = 0; k < images[i].seen.size(); ++k) {
      const auto at = static_cast<std::size_t>(images[i].observation[k]);
      of.landmark[at] = found.landmark[i][k];
      of.probability[at] = found.probability[i][k];
    }
  }
  map.landmarks = found.landmarks;
  for (std::size_t r = 0; r < steps.size(); ++r)
    map.rows.push_back(RowsOfEm(map.paths[r], log.robot[r].observations, map.landmarks));
  map.refined = RefineWithAllRows(log, map.paths, settings, &map.landmarks, &map.rows);
  return map;
}

std::optional<double> BehindOdometry(const FittedMap& map, const FittedMap& along) {
  if (!along.refined.refused.empty()) return std::nullopt;
  if (!map.refined.refused.empty()) return std::numeric_limits<double>::infinity();
  const auto cost = [](const FittedMap& of, const FittedMap& beside) {
    const std::int64_t unexplained = RowsOfNone(of.rows) + std::ssize(of.landmarks);
    return CostBeside(of.refined, beside.refined) + kOfNoLandmark_nats * static_cast<double>(unexplained);
  };
  return cost(map, along) - cost(along, map);
}

std::optional<FittedMap> BetterAlongOdometry(const FittedMap& of_search, const kinds::Log& log,
                                             const std::vector<RobotSteps>& steps, const Settings& settings) {
  constexpr double kClear_nats = 10;
  if (!ExplainsLittle(of_search)) return std::nullopt;
  FittedMap along = LaidAlongOdometry(log, steps, settings);
  if (const auto behind_nats = BehindOdometry(of_search, along))
    return *behind_nats < kClear_nats ? std::nullopt : std::optional(std::move(along));
  if (of_search.refined.refused.empty()) return std::nullopt;
  FittedMap none = of_search;
  none.landmarks.clear();
  none.refined.landmarks.clear();
  for (RowAssociations& robot : none.rows) {
    std::ranges::fill(robot.landmark, -1);
    std::ranges::fill(robot.probability, 0.0);
  }
  return none;
}

}  // namespace cairn::landmark_map
