// Rooms for tests: walls that a ring of 24 sonars on a turret hears, from a robot that drives in them.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "pipelines/common/pose.h"
#include "pipelines/local_map/plane.h"
#include "pipelines/local_map/ring.h"
#include "schema/rng.h"

namespace cairn::local_map {

struct TestWall {
  Point a, b;
};

inline std::vector<Pose> RingBeams(int count = 24, double radius_m = 0.25) {
  std::vector<Pose> beams;
  for (int b = 0; b < count; ++b) {
    const double heading = b * 2 * std::numbers::pi / count;
    beams.push_back({radius_m * std::cos(heading), radius_m * std::sin(heading), heading});
  }
  return beams;
}

inline double RayM(const std::vector<TestWall>& walls, const Pose& from) {
  const double ux = std::cos(from.heading_rad), uy = std::sin(from.heading_rad);
  double nearest = std::numeric_limits<double>::infinity();
  for (const TestWall& wall : walls) {
    const double wx = wall.b.x_m - wall.a.x_m, wy = wall.b.y_m - wall.a.y_m;
    const double dx = wall.a.x_m - from.x_m, dy = wall.a.y_m - from.y_m;
    const double det = wx * uy - wy * ux;
    if (std::abs(det) < 1e-12) continue;
    const double range = (wx * dy - wy * dx) / det, along = (ux * dy - uy * dx) / det;
    if (range > 0 && along >= 0 && along <= 1) nearest = std::min(nearest, range);
  }
  return nearest;
}

// The nearest wall in the cone; NaN beyond 6 m.
inline double SonarM(const std::vector<TestWall>& walls, const Pose& from, Rng& rng) {
  constexpr double kOpeningRad = 0.2618;
  double nearest = std::numeric_limits<double>::infinity();
  for (int k = -4; k <= 4; ++k)
    nearest = std::min(nearest, RayM(walls, Compose(from, {0, 0, k * kOpeningRad / 8})));
  nearest += 0.03 * rng.Normal();
  return nearest <= 6 ? nearest : std::numeric_limits<double>::quiet_NaN();
}

inline std::vector<double> SonarSweep(const std::vector<TestWall>& walls, const Pose& robot,
                                      double turret_rad, Rng& rng) {
  std::vector<double> ranges;
  const Pose turret = Compose(robot, {0, 0, turret_rad});
  for (const Pose& beam : RingBeams()) ranges.push_back(SonarM(walls, Compose(turret, beam), rng));
  return ranges;
}

// A rectangle of `width_m` by `depth_m` about the origin, turned.
inline std::vector<TestWall> TestRoom(double width_m, double depth_m, double turned_rad) {
  std::vector<Point> corners;
  for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
    const Pose at = Compose({0, 0, turned_rad}, {x * width_m / 2, y * depth_m / 2, 0});
    corners.push_back({at.x_m, at.y_m});
  }
  std::vector<TestWall> walls;
  for (std::size_t k = 0; k < 4; ++k) walls.push_back({corners[k], corners[(k + 1) % 4]});
  return walls;
}

}  // namespace cairn::local_map
