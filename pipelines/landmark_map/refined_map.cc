#include "pipelines/landmark_map/refined_map.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include "pipelines/common/handed_over.h"
#include "pipelines/landmark_map/estimate.h"
#include "pipelines/landmark_map/landmarks/image_landmarks.h"
#include "pipelines/landmark_map/model/m_step.h"
#include "pipelines/landmark_map/refinement/along_odometry.h"
#include "pipelines/landmark_map/refinement/robot_ties.h"
#include "pipelines/landmark_map/refinement/seen_beside.h"

namespace cairn::landmark_map {
namespace {

// The variances of the steps' positions, an axis.
void AddPositionVariance(const std::vector<Blob>& summaries, double* sum, double* count) {
  const std::vector<double> covariance = Joined(summaries, "pose/covariance");
  for (std::size_t at = 0; at + 9 <= covariance.size(); at += 9) {
    *sum += 0.5 * (covariance[at] + covariance[at + 4]);
    ++*count;
  }
}

// Leaves out the landmarks without identity; their observations are of none.
void DropUnidentified(const MapRules& rules, std::vector<Landmark>* landmarks,
                      std::vector<Associated>* associated) {
  std::vector<std::int32_t> now;
  std::vector<Landmark> kept;
  for (const Landmark& landmark : *landmarks) {
    const bool stays = landmark.type != rules.types;
    now.push_back(stays ? static_cast<std::int32_t>(kept.size()) : -1);
    if (stays) kept.push_back(landmark);
  }
  *landmarks = std::move(kept);
  for (Associated& of : *associated) {
    for (std::int32_t& landmark : of.landmark)
      landmark = landmark < 0 ? -1 : now[static_cast<std::size_t>(landmark)];
  }
}

// From types to indices; what is of no landmark goes.
void NumberNamed(const std::vector<Landmark>& landmarks, std::vector<ImageObservations>* images) {
  for (ImageObservations& image : *images) {
    std::vector<NamedInImage> numbered;
    for (NamedInImage seen : image.named) {
      const auto at = std::ranges::find(landmarks, seen.landmark, &Landmark::type);
      if (at == landmarks.end()) continue;
      seen.landmark = static_cast<std::int32_t>(at - landmarks.begin());
      numbered.push_back(seen);
    }
    image.named = std::move(numbered);
  }
}

// Landmarks without identity that were seen at a distance are found anew, from whole images.
void FindInImages(const kinds::Log& log, const Settings& settings, const std::vector<RobotSteps>& steps,
                  const RoundSum& sum, const std::vector<OdometryFit>& odometry,
                  std::vector<Landmark>* landmarks, std::vector<Associated>* associated) {
  std::vector<ImageObservations> images;
  double variance_m2 = 0.0, poses = 0.0;
  for (std::size_t r = 0; r < odometry.size(); ++r) {
    const std::vector<Blob> summaries = sum.SummariesOf(r);
    AppendImages(
        steps[r].WithoutDrift(odometry[r].drift_rad_per_m), settings.map.types, r,
        Joined(summaries, "pose/mode_x_m"), Joined(summaries, "pose/mode_y_m"),
        Joined(summaries, "pose/mode_heading_rad"),
        settings.map.partly_named ? log.robot[r].observations.time_s.values() : std::span<const double>(),
        &images);
    AddPositionVariance(summaries, &variance_m2, &poses);
  }
  if (std::ranges::all_of(images, [](const ImageObservations& image) { return image.seen.empty(); })) return;
  DropUnidentified(settings.map, landmarks, associated);
  const double sigma_m = std::hypot(settings.in_image_m, std::sqrt(variance_m2 / poses));
  std::vector<Point> named;
  for (const Landmark& landmark : *landmarks) named.push_back({landmark.x_m, landmark.y_m});
  NumberNamed(*landmarks, &images);
  const ImageLandmarks found =
      FindImageLandmarks(images, {sigma_m, settings.map.grid.cell_m, settings.map.types}, named);
  landmarks->insert(landmarks->end(), found.landmarks.begin(), found.landmarks.end());
  for (std::size_t i = 0; i < images.size(); ++i) {
    for (std::size_t k = 0; k < images[i].seen.size(); ++k) {
      Associated& of = (*associated)[images[i].robot];
      const auto at = static_cast<std::size_t>(images[i].observation[k]);
      of.landmark[at] = found.landmark[i][k];
      of.probability[at] = found.probability[i][k];
    }
  }
}

// Whether these observations say where a robot is and how it faces: they are of two landmarks at least.
bool HoldARobot(const RowAssociations& rows) {
  std::vector<std::int32_t> seen;
  for (std::size_t i = 0; i < rows.landmark.size(); ++i)
    if (rows.landmark[i] >= 0 && rows.probability[i] >= 0.5) seen.push_back(rows.landmark[i]);
  return std::ranges::any_of(seen, [&](std::int32_t landmark) { return landmark != seen.front(); });
}

// Of contact detections whose landmarks the least squares has placed: the paths, too, and all covariances by
// the widths that errors show. Not where it would move a landmark by more than the core and three of its
// standard deviations: a map may be a few per cent too large, and its far end lie by as much elsewhere. Nor
// where a robot hangs on one landmark.
void RefineContacts(const kinds::Log& log, const std::vector<AssociatedPath>& paths, const Settings& settings,
                    RefinedMap* map) {
  if (!std::ranges::all_of(map->rows, HoldARobot)) return;
  JointRefinement joint = RefineJointly(log, paths, map->rows, settings, map->landmarks);
  if (!joint.refused.empty()) return;
  for (std::size_t l = 0; l < joint.landmarks.size(); ++l) {
    const Landmark &before = map->landmarks[l], &now = joint.landmarks[l];
    const double sigma_m = std::sqrt(now.covariance_m2[0] + now.covariance_m2[3]);
    if (!(std::hypot(now.x_m - before.x_m, now.y_m - before.y_m) <= settings.map.core_m + 3 * sigma_m))
      return;
  }
  map->landmarks = std::move(joint.landmarks);
  map->covariance = std::move(joint.covariance);
  map->contact_paths = std::move(joint.paths);
}

// The steps of all robots; they are of this log's rows.
std::vector<RobotSteps> StepsIn(const kinds::Log& log, const Settings& settings, const Inputs& inputs) {
  RequireSize("the map's identities", static_cast<std::size_t>(settings.map.types), log.landmarks.size());
  std::vector<RobotSteps> steps;
  for (std::size_t r = 0; r < log.robot.size(); ++r) {
    steps.push_back(RobotSteps::In(*inputs.Get("steps/" + std::to_string(r)), settings.map.layers(),
                                   settings.map.grid.cell_m));
    RequireSize("row_observation", steps.back().row_observation.size(),
                log.robot[r].observations.time_s.size());
  }
  return steps;
}

}  // namespace

LayeredGrid CountsIn(const Inputs& inputs, const Settings& settings) {
  LayeredGrid counts = LayeredGrid::Load("counts/", *inputs.Get("counts"));
  CheckCounts(counts, settings.map);
  Box box;
  for (const Layer& layer : counts.layers) box = Union(box, layer.box);
  RequireMemory("the map", sizeof(double) * static_cast<double>(box.cells()), settings.memory_mb);
  RequireMemory("the M-step", MStepBytes(counts, settings.map), settings.memory_mb);
  return counts;
}

bool IsGivenMap(const Inputs& inputs, const LayeredGrid& counts) {
  return inputs.Has("map") && counts.cells() == 0;
}

RefinedMap RefineMapOf(const Blob& blob, const Settings& settings, const Inputs& inputs, const RoundSum& sum,
                       const std::vector<OdometryFit>& odometry, std::string not_refined, bool jointly,
                       const std::vector<InTwoPlaces>& in_two_places) {
  const auto log = Read<kinds::Log>(blob);
  RefinedMap map;
  map.steps = StepsIn(log, settings, inputs);
  map.landmarks = LandmarksIn(*inputs.Get("landmarks"), settings.map);
  std::vector<AssociatedPath> paths = AssociatedPaths(sum, map.steps, odometry, map.landmarks.size());
  std::vector<Associated> associated = ColumnOf(paths, &AssociatedPath::associated);
  // Which class a landmark is of only the counts tell.
  if (settings.map.classes.count == 1 && !IsGivenMap(inputs, CountsIn(inputs, settings)) &&
      !settings.incremental) {
    FindInImages(log, settings, map.steps, sum, odometry, &map.landmarks, &associated);
  }
  const bool refines = jointly && not_refined.empty();
  if (refines) AddSeenBeside(log, paths, settings.steps.until_s, &map.landmarks, &associated);
  for (std::size_t r = 0; r < paths.size(); ++r) {
    paths[r].associated = associated[r];
    map.rows.push_back(RowsOfEm(paths[r], log.robot[r].observations, map.landmarks));
  }
  map.found = map.landmarks;
  map.moved =
      RefineAllThatStayed(blob, paths, settings, in_two_places, refines, &map.found, &map.rows, &map.refined);
  const auto is_named = [&](const Landmark& landmark) { return landmark.type < settings.map.types; };
  if (refines && paths.size() == 1 && settings.map.classes.count == 1 &&
      std::ranges::none_of(map.found, is_named)) {
    std::optional<FittedMap> along;
    if (inputs.Has("search"))
      along = BetterAlongOdometry({paths, map.found, map.rows, map.refined}, log, map.steps, settings);
    if (along) {
      map.along_odometry = true;
      map.found = std::move(along->landmarks);
      map.rows = std::move(along->rows);
      map.refined = std::move(along->refined);
    }
    if (map.refined.refused.empty() && !map.along_odometry)
      map.shift = WeighShifts(log, paths, settings, &map.found, &map.rows, &map.refined);
  }
  if (refines) {
    map.landmarks = map.refined.landmarks;
    map.covariance = map.refined.covariance;
  }
  if (!jointly && not_refined.empty()) RefineContacts(log, paths, settings, &map);
  map.not_refined = map.refined.refused.empty() ? std::move(not_refined) : "refused: " + map.refined.refused;
  return map;
}

std::optional<std::vector<Landmark>> PlacedAnew(const Blob& blob, const RefinedMap& map,
                                                const Settings& settings) {
  if (map.refined.paths.size() < 2 || settings.map.classes.count > 1) return std::nullopt;
  const auto placed = PlacedRows(Read<kinds::Log>(blob), map.refined, map.rows, settings.steps.until_s);
  const double sigma_m = TieSigma_m(placed, map.refined.fit);
  if (!(sigma_m > 0)) return std::nullopt;
  return PlacedAnew(placed, map.landmarks, settings.map.types, sigma_m);
}

}  // namespace cairn::landmark_map
