// Walls, and what a range sensor between them measures.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "schema/geometry.h"

namespace cairn::datasets {

struct Wall {
  Point a, b;
};

// A part of a segment, from 0 to 1 along it.
struct Part {
  double from = 0, to = 1;
};

// The part of a-b inside a convex shape, of which the corners are given, counter-clockwise; empty where from
// >= to.
Part Inside(Point a, Point b, std::span<const Point> corners);

// Adds what of a-b lies in none of `inside`.
void AddOutside(Point a, Point b, std::vector<Part> inside, std::vector<Wall>& walls);

// What lies within `half_opening_rad` (below pi/2; 0: a ray) of a direction.
class Cone {
 public:
  Cone(Point from, double heading_rad, double half_opening_rad);
  // The nearest point of the wall in the cone, seen from its tip; none: the wall is not in it.
  std::optional<Point> Nearest(const Wall& wall) const;

 private:
  Point from_, right_, middle_, left_;
};

double DistanceToM(const Wall& wall, Point from);

// Whether the wall crosses the path from one point to another, but at its very ends.
bool Crosses(const Wall& wall, Point from, Point to);

// Distance to the nearest point of any wall within `half_opening_rad` (below pi/2; 0: a ray) of
// `heading_rad`; infinite where there is none. Nothing can hide the nearest point.
double NearestWallM(const std::vector<Wall>& walls, Point from, double heading_rad, double half_opening_rad);

}  // namespace cairn::datasets
