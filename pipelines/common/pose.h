// A pose in the plane, x ahead at heading 0, headings counter-clockwise.
#pragma once

#include <cmath>
#include <numbers>

namespace cairn {

struct Pose {
  double x_m = 0, y_m = 0, heading_rad = 0;
};

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

// Into [-pi, pi].
inline double Wrapped(double angle_rad) { return std::remainder(angle_rad, 2 * std::numbers::pi); }

}  // namespace cairn
