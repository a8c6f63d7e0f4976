// Of which point of the robot true positions are, and in a frame of which scale, where that is not the
// robot's own point and the true landmarks' frame.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "datasets/evaluate/matching/similarity.h"
#include "schema/geometry.h"

namespace cairn::datasets {

// What is known of it: `at`, x ahead of the robot and y to its left, or nothing, then it is estimated with
// the frame.
struct ReferencePoint {
  bool estimated = false;
  Point at;

  // "estimate", or "X,Y" in metres. Throws InputError.
  static ReferencePoint Parse(const std::string& text);
};

struct Reference {
  Similarity to_map;         // from the true positions' frame to the map's
  std::vector<Point> point;  // of each robot
  double rmse_m = 0;         // how far off the points are then
};

// Poses of the map, and the true positions at their times.
using PosesAndPositions = std::vector<std::pair<Pose, Point>>;

// The least squares over all robots' poses. None where these do not tell it: too few, or of a robot that
// never turns.
std::optional<Reference> FitReference(const std::vector<PosesAndPositions>& robots);

}  // namespace cairn::datasets
