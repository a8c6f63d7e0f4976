// Points and poses in the plane: metres, x ahead at heading 0, headings in radians counter-clockwise from x.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

namespace cairn {

// Their `Fields` are as schema/kinds/fields.h says.
struct Point {
  double x_m = 0, y_m = 0;
  static void Fields(const auto& field) {
    field("x_m", &Point::x_m);
    field("y_m", &Point::y_m);
  }
};

struct Pose {
  double x_m = 0, y_m = 0, heading_rad = 0;
  static void Fields(const auto& field) {
    field("x_m", &Pose::x_m);
    field("y_m", &Pose::y_m);
    field("heading_rad", &Pose::heading_rad);
  }
};

inline double DistanceM(Point a, Point b) { return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m); }

// Into (-pi, pi].
inline double WrapAngle(double angle_rad) {
  const double wrapped = std::remainder(angle_rad, 2 * std::numbers::pi);
  return wrapped <= -std::numbers::pi ? std::numbers::pi : wrapped;
}

// T_world_b of T_world_a and T_a_b. The heading is not wrapped.
inline Pose Compose(const Pose& a, const Pose& b) {
  const double c = std::cos(a.heading_rad), s = std::sin(a.heading_rad);
  return {a.x_m + c * b.x_m - s * b.y_m, a.y_m + s * b.x_m + c * b.y_m, a.heading_rad + b.heading_rad};
}

// T_a_b of T_world_a and T_world_b: Compose(a, Between(a, b)) is b.
inline Pose Between(const Pose& a, const Pose& b) {
  const double c = std::cos(a.heading_rad), s = std::sin(a.heading_rad);
  const double dx = b.x_m - a.x_m, dy = b.y_m - a.y_m;
  return {c * dx + s * dy, -s * dx + c * dy, b.heading_rad - a.heading_rad};
}

// `pose` as seen from `from`: Between, its heading wrapped.
inline Pose Relative(const Pose& from, const Pose& pose) {
  Pose seen = Between(from, pose);
  seen.heading_rad = WrapAngle(seen.heading_rad);
  return seen;
}

// The pose a `share` of the way from a to b: its position on the line, its heading along the shorter arc,
// wrapped.
inline Pose Interpolate(const Pose& a, const Pose& b, double share) {
  return {a.x_m + share * (b.x_m - a.x_m), a.y_m + share * (b.y_m - a.y_m),
          WrapAngle(a.heading_rad + share * WrapAngle(b.heading_rad - a.heading_rad))};
}

// Where a grid lies and how fine it is. Cell (i, j), column i and row j, covers [origin + i cell, origin + (i
// + 1) cell) in x, likewise in y; row 0 is the lowest.
struct GridBox {
  double origin_x_m = 0, origin_y_m = 0, cell_m = 1;
  std::int64_t columns = 0, rows = 0;

  std::int64_t cells() const { return columns * rows; }
  // May lie outside; what is farther than any map reaches counts as that far: no number is too large for an
  // index.
  std::int64_t ColumnOf(double x_m) const { return CellAt((x_m - origin_x_m) / cell_m); }
  std::int64_t RowOf(double y_m) const { return CellAt((y_m - origin_y_m) / cell_m); }
  bool Holds(std::int64_t column, std::int64_t row) const {
    return column >= 0 && column < columns && row >= 0 && row < rows;
  }
  std::size_t Index(std::int64_t column, std::int64_t row) const {
    return static_cast<std::size_t>(row * columns + column);
  }
  double CentreX(std::int64_t column) const {
    return origin_x_m + (static_cast<double>(column) + 0.5) * cell_m;
  }
  double CentreY(std::int64_t row) const { return origin_y_m + (static_cast<double>(row) + 0.5) * cell_m; }
  Point Centre(std::int64_t column, std::int64_t row) const { return {CentreX(column), CentreY(row)}; }
  static void Fields(const auto& field) {
    field("origin_x_m", &GridBox::origin_x_m);
    field("origin_y_m", &GridBox::origin_y_m);
    field("cell_m", &GridBox::cell_m);
    field("columns", &GridBox::columns);
    field("rows", &GridBox::rows);
  }

 private:
  static std::int64_t CellAt(double cells) {
    constexpr double kFar = 1e12;
    return static_cast<std::int64_t>(std::floor(std::clamp(cells, -kFar, kFar)));
  }
};

}  // namespace cairn
