// Similarity transforms of the plane, and their least-squares fit to pairs of points.
#pragma once

#include <vector>

#include "schema/geometry.h"

namespace cairn::datasets {

// to = scale R(angle) from + shift.
struct Similarity {
  double scale = 1;
  double angle_rad = 0;
  double x_m = 0;
  double y_m = 0;

  Point operator()(Point from) const;
  Pose operator()(const Pose& from) const;
};

// The way back.
Similarity Inverse(const Similarity& there);

struct PointPair {
  Point from;
  Point to;
};

// The rotation and shift, never a reflection, with the least sum of squared distances between the transformed
// `from` and `to`: S. Umeyama, Least-squares estimation of transformation parameters between two point
// patterns, PAMI 13 (1991), in its closed form for the plane. One pair (or several in one place) fixes the
// shift only; none gives the identity.
Similarity FitRigid(const std::vector<PointPair>& pairs);

// As FitRigid, with a scale; that stays 1 where the points do not fix one.
Similarity FitSimilarity(const std::vector<PointPair>& pairs);

// Root of the mean squared distance after the transform; NaN without pairs.
double RmseM(const std::vector<PointPair>& pairs, const Similarity& transform);

}  // namespace cairn::datasets
