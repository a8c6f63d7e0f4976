#include "datasets/common/walls.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cairn::datasets {
namespace {

double Cross(Point u, Point v) { return u.x_m * v.y_m - u.y_m * v.x_m; }
Point Minus(Point a, Point b) { return {a.x_m - b.x_m, a.y_m - b.y_m}; }
Point Between(Point a, Point b, double t) {
  return {a.x_m + t * (b.x_m - a.x_m), a.y_m + t * (b.y_m - a.y_m)};
}

// Cuts `part` of a-b to where `along(point)` is positive; `along` is linear.
void CutTo(double at_a, double at_b, Part& part) {
  const double slope = at_b - at_a;
  if (slope == 0) {
    if (at_a <= 0) part.to = part.from;
  } else if (slope > 0) {
    part.from = std::max(part.from, -at_a / slope);
  } else {
    part.to = std::min(part.to, -at_a / slope);
  }
}

// Of the perpendicular from the origin to a line through a along ab: the share of ab.
double FootOn(Point a, Point ab) {
  return -(a.x_m * ab.x_m + a.y_m * ab.y_m) / std::max(ab.x_m * ab.x_m + ab.y_m * ab.y_m, 1e-18);
}

}  // namespace

Part Inside(Point a, Point b, std::span<const Point> corners) {
  Part part;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Point corner = corners[i], side = Minus(corners[(i + 1) % corners.size()], corner);
    CutTo(Cross(side, Minus(a, corner)), Cross(side, Minus(b, corner)), part);
  }
  return part;
}

void AddOutside(Point a, Point b, std::vector<Part> inside, std::vector<Wall>& walls) {
  std::sort(inside.begin(), inside.end(), [](const Part& p, const Part& q) { return p.from < q.from; });
  inside.push_back({1, 1});
  double done = 0;
  for (const Part& part : inside) {
    if (part.from > done) walls.push_back({Between(a, b, done), Between(a, b, part.from)});
    done = std::max(done, part.to);
  }
}

Cone::Cone(Point from, double heading_rad, double half_opening_rad)
    : from_(from),
      right_{std::cos(heading_rad - half_opening_rad), std::sin(heading_rad - half_opening_rad)},
      middle_{std::cos(heading_rad), std::sin(heading_rad)},
      left_{std::cos(heading_rad + half_opening_rad), std::sin(heading_rad + half_opening_rad)} {}

std::optional<Point> Cone::Nearest(const Wall& wall) const {
  // Rounding must not close a cone without opening.
  constexpr double kSlackM = 1e-9;
  const Point a = Minus(wall.a, from_), b = Minus(wall.b, from_), ab = Minus(b, a);
  Part seen;
  CutTo(Cross(right_, a) + kSlackM, Cross(right_, b) + kSlackM, seen);
  CutTo(Cross(a, left_) + kSlackM, Cross(b, left_) + kSlackM, seen);
  const auto ahead = [&](Point p) { return p.x_m * middle_.x_m + p.y_m * middle_.y_m; };
  CutTo(ahead(a), ahead(b), seen);
  if (seen.from >= seen.to) return std::nullopt;
  return Between(a, b, std::clamp(FootOn(a, ab), seen.from, seen.to));
}

double DistanceToM(const Wall& wall, Point from) {
  const Point a = Minus(wall.a, from), b = Minus(wall.b, from);
  return DistanceM({}, Between(a, b, std::clamp(FootOn(a, Minus(b, a)), 0.0, 1.0)));
}

bool Crosses(const Wall& wall, Point from, Point to) {
  constexpr double kEnd = 1e-6;  // of the way
  const Point path = Minus(to, from), along = Minus(wall.b, wall.a), a = Minus(wall.a, from);
  const double turn = Cross(path, along);
  if (turn == 0) return false;
  const double on_path = Cross(a, along) / turn, on_wall = Cross(a, path) / turn;
  return on_path > kEnd && on_path < 1 - kEnd && on_wall >= 0 && on_wall <= 1;
}

double NearestWallM(const std::vector<Wall>& walls, Point from, double heading_rad, double half_opening_rad) {
  const Cone cone(from, heading_rad, half_opening_rad);
  double nearest = std::numeric_limits<double>::infinity();
  for (const Wall& wall : walls) {
    if (const auto point = cone.Nearest(wall)) nearest = std::min(nearest, DistanceM({}, *point));
  }
  return nearest;
}

}  // namespace cairn::datasets
