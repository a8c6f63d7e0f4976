// Which of the map's landmarks are none: a place where something was observed once, and nothing on the many
// ways past it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "pipelines/landmark_map/landmarks/summary.h"
#include "schema/blob.h"

namespace cairn::landmark_map {

// As a data sheet states them; nothing is a false landmark where false_ratio is 0.
struct Detection {
  double false_ratio = 0.0;  // share of the observations that are of nothing
  double miss_ratio = 0.03;  // probability that a landmark is passed unnoticed
  // Whether it is known when a landmark was passed: of contact detections without identities.
  bool tells_passes = true;
};

// How often robots passed a landmark, and how often one of its observations was made.
struct Passes {
  int passed = 0;
  int observed = 0;
};

// ln P(a landmark | passes) / P(false observations | passes), for a place with one observation at least. Its
// first observation was of a landmark or false as the ratio says; a further one at the same place is made of
// a landmark by 1 - miss_ratio, by chance with `coincidence`; a pass without by miss_ratio, or surely.
double LogOddsOfLandmark(const Passes& passes, const Detection& detection, double coincidence);

// A visit begins within `reach_m` of the place and ends beyond twice as much.
int CountVisits(std::span<const double> x_m, std::span<const double> y_m, double at_x_m, double at_y_m,
                double reach_m);

// Of each landmark, by a result's paths (robot/N/poses/) and associations
// (robot/N/observations/map_landmark).
std::vector<Passes> CountPasses(const Blob& result, const std::vector<Landmark>& landmarks, double reach_m);

// For each landmark, whether there is one, by its passes. For contact detections.
std::vector<bool> AreLandmarks(const Blob& result, const std::vector<Landmark>& landmarks,
                               const Detection& detection, double reach_m);

// Leaves only those that `keep` says, in `landmarks`, in their joint `covariance` [2K,2K], which may be
// empty, and in the result's associations.
void KeepLandmarks(const std::vector<bool>& keep, std::vector<Landmark>* landmarks,
                   Eigen::MatrixXd* covariance, Blob* result);

}  // namespace cairn::landmark_map
