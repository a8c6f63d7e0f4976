// The walls of a corridor world, and what a range sensor in it measures.
#pragma once

#include <optional>
#include <vector>

#include "datasets/planar.h"
#include "datasets/simulate_world.h"

namespace cairn::datasets {

struct Wall {
  PointM a, b;
};

// From a corridor's axis to its walls. Robots in a hurry cut corners by up to 2 m.
inline constexpr double kCorridorHalfWidthM = 2.2;

// The outline of all corridors together. A corridor is the rectangle round its axis, half a width longer at
// each end; where corridors meet, what lies inside another is no wall.
std::vector<Wall> WallsOf(const CorridorWorld& world);

// A part of a segment, from 0 to 1 along it.
struct Part {
  double from = 0, to = 1;
};

// Adds what of a-b lies in none of `inside`.
void AddOutside(PointM a, PointM b, std::vector<Part> inside, std::vector<Wall>& walls);

// What lies within `half_opening_rad` (below pi/2; 0: a ray) of a direction.
class Cone {
 public:
  Cone(PointM from, double heading_rad, double half_opening_rad);
  // The nearest point of the wall in the cone, seen from its tip; none: the wall is not in it.
  std::optional<PointM> Nearest(const Wall& wall) const;

 private:
  PointM from_, right_, middle_, left_;
};

double DistanceToM(const Wall& wall, PointM from);

// Whether the wall crosses the way from one point to another, but at its very ends.
bool Crosses(const Wall& wall, PointM from, PointM to);

// Distance to the nearest point of any wall within `half_opening_rad` (below pi/2; 0: a ray) of
// `heading_rad`; infinite where there is none. Nothing can hide the nearest point.
double NearestWallM(const std::vector<Wall>& walls, PointM from, double heading_rad, double half_opening_rad);

}  // namespace cairn::datasets
