#include "pipelines/landmark_map/landmarks/false_landmarks.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace cairn::landmark_map {
namespace {

std::string Robot(std::size_t r, const char* what) { return "robot/" + std::to_string(r) + "/" + what; }

std::size_t RobotsOf(const Blob& result) { return result.Texts("robots").size(); }

// The way of all robots.
double PathLengthM(const Blob& result) {
  double travelled = 0.0;
  for (std::size_t r = 0; r < RobotsOf(result); ++r) {
    const auto x = result.Get<double>(Robot(r, "poses/x_m")), y = result.Get<double>(Robot(r, "poses/y_m"));
    for (std::size_t i = 1; i < x.size(); ++i) travelled += std::hypot(x[i] - x[i - 1], y[i] - y[i - 1]);
  }
  return travelled;
}

}  // namespace

double LogOddsOfLandmark(const Passes& passes, const Detection& detection, double coincidence) {
  const int missed = std::max(0, passes.passed - passes.observed);
  // [TBF98] section 2.2: perception errs. Bayes' rule over the passes of the place.
  return std::log((1.0 - detection.false_ratio) / detection.false_ratio) +
         (passes.observed - 1) * std::log((1.0 - detection.miss_ratio) / coincidence) +
         missed * std::log(detection.miss_ratio);
}

int CountVisits(std::span<const double> x_m, std::span<const double> y_m, double at_x_m, double at_y_m,
                double reach_m) {
  int visits = 0;
  bool inside = false;
  for (std::size_t i = 0; i < x_m.size(); ++i) {
    const double distance = std::hypot(x_m[i] - at_x_m, y_m[i] - at_y_m);
    if (!inside && distance < reach_m) ++visits;
    inside = inside ? distance < 2.0 * reach_m : distance < reach_m;
  }
  return visits;
}

std::vector<Passes> CountPasses(const Blob& result, const std::vector<Landmark>& landmarks, double reach_m) {
  std::vector<Passes> passes(landmarks.size());
  for (std::size_t r = 0; r < RobotsOf(result); ++r) {
    const auto x = result.Get<double>(Robot(r, "poses/x_m")), y = result.Get<double>(Robot(r, "poses/y_m"));
    for (std::size_t k = 0; k < landmarks.size(); ++k)
      passes[k].passed += CountVisits(x, y, landmarks[k].x_m, landmarks[k].y_m, reach_m);
    for (const std::int32_t k : result.Get<std::int32_t>(Robot(r, "observations/map_landmark")))
      if (k >= 0) ++passes[static_cast<std::size_t>(k)].observed;
  }
  return passes;
}

std::vector<bool> AreLandmarks(const Blob& result, const std::vector<Landmark>& landmarks,
                               const Detection& detection, double reach_m) {
  const std::vector<Passes> passes = CountPasses(result, landmarks, reach_m);
  double observations = 0.0;
  for (std::size_t r = 0; r < RobotsOf(result); ++r)
    observations +=
        static_cast<double>(result.Get<std::int32_t>(Robot(r, "observations/map_landmark")).size());
  // A false contact detection falls anywhere on the way.
  const double false_per_m = detection.false_ratio * observations / PathLengthM(result);
  const double coincidence = std::min(0.5, 2.0 * reach_m * false_per_m);
  std::vector<bool> keep;
  for (const Passes& p : passes)
    keep.push_back(p.observed > 0 && LogOddsOfLandmark(p, detection, coincidence) > 0.0);
  return keep;
}

void KeepLandmarks(const std::vector<bool>& keep, std::vector<Landmark>* landmarks,
                   Eigen::MatrixXd* covariance, Blob* result) {
  std::vector<std::int32_t> now(keep.size(), -1);
  std::vector<Landmark> kept;
  std::vector<Eigen::Index> axes;
  for (std::size_t k = 0; k < keep.size(); ++k) {
    if (!keep[k]) continue;
    for (std::size_t axis = 2 * k; axis < 2 * k + 2; ++axis) axes.push_back(static_cast<Eigen::Index>(axis));
    now[k] = static_cast<std::int32_t>(kept.size());
    kept.push_back((*landmarks)[k]);
  }
  *landmarks = std::move(kept);
  if (covariance->size() > 0) *covariance = (*covariance)(axes, axes).eval();
  for (std::size_t r = 0; r < RobotsOf(*result); ++r) {
    const std::string name = Robot(r, "observations/map_landmark");
    const auto old = result->Get<std::int32_t>(name);
    std::vector<std::int32_t> rows;
    for (const std::int32_t k : old) rows.push_back(k < 0 ? -1 : now[static_cast<std::size_t>(k)]);
    result->PutVector(name, rows);
  }
}

}  // namespace cairn::landmark_map
