#include "datasets/simulate/walls.h"

#include <array>
#include <utility>

namespace cairn::datasets {
namespace {

// A rectangle as its corners, counter-clockwise.
using Corridor = std::array<Point, 4>;

Corridor CorridorAlong(Point a, Point b) {
  const double length = DistanceM(a, b), h = kCorridorHalfWidthM;
  const Point u{(b.x_m - a.x_m) / length * h, (b.y_m - a.y_m) / length * h};
  return {Point{a.x_m - u.x_m + u.y_m, a.y_m - u.y_m - u.x_m},
          Point{b.x_m + u.x_m + u.y_m, b.y_m + u.y_m - u.x_m},
          Point{b.x_m + u.x_m - u.y_m, b.y_m + u.y_m + u.x_m},
          Point{a.x_m - u.x_m - u.y_m, a.y_m - u.y_m + u.x_m}};
}

}  // namespace

std::vector<Wall> WallsOf(const CorridorWorld& world) {
  std::vector<Corridor> corridors;
  for (const auto& [a, b] : world.Edges()) corridors.push_back(CorridorAlong(world.nodes[a], world.nodes[b]));
  std::vector<Wall> walls;
  for (std::size_t i = 0; i < corridors.size(); ++i) {
    for (std::size_t side = 0; side < 4; ++side) {
      const Point a = corridors[i][side], b = corridors[i][(side + 1) % 4];
      std::vector<Part> inside;
      for (std::size_t k = 0; k < corridors.size(); ++k) {
        if (k == i) continue;
        if (const Part part = Inside(a, b, corridors[k]); part.from < part.to) inside.push_back(part);
      }
      AddOutside(a, b, std::move(inside), walls);
    }
  }
  return walls;
}

}  // namespace cairn::datasets
