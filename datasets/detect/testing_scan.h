// What a laser sees among posts and walls: rays against circles and segments, by no code of the detector's.
#pragma once

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "datasets/detect/posts.h"
#include "schema/rng.h"

namespace cairn::datasets {

inline BeamFan FanOf(int beams, double first_rad, double step_rad) {
  std::vector<double> zero(static_cast<std::size_t>(beams)), angle;
  for (int i = 0; i < beams; ++i) angle.push_back(WrapAngle(first_rad + i * step_rad));
  return {zero, zero, angle};
}

inline const BeamFan& HalfTurn() {
  static const BeamFan fan = FanOf(361, -std::numbers::pi / 2, std::numbers::pi / 360);
  return fan;
}

struct ScanWorld {
  struct Circle {
    double x_m, y_m, radius_m;
  };
  struct Segment {
    double x0_m, y0_m, x1_m, y1_m;
  };
  std::vector<Circle> circles;
  std::vector<Segment> segments;

  // NaN: nothing within 30 m.
  std::vector<double> Scan(const BeamFan& fan, const Pose& from, double sd_m = 0, Rng* rng = nullptr) const {
    constexpr double kReach_m = 30;
    std::vector<double> range_m;
    for (std::size_t i = 0; i < fan.size(); ++i) {
      const double angle = from.heading_rad + fan.angle_rad(i), c = std::cos(angle), s = std::sin(angle);
      double nearest = kReach_m;
      for (const Circle& circle : circles) {
        const double x = circle.x_m - from.x_m, y = circle.y_m - from.y_m;
        const double along = x * c + y * s, across = y * c - x * s;
        if (along > 0 && std::abs(across) < circle.radius_m)
          nearest = std::min(nearest, along - std::sqrt(circle.radius_m * circle.radius_m - across * across));
      }
      for (const Segment& wall : segments) {
        const double dx = wall.x1_m - wall.x0_m, dy = wall.y1_m - wall.y0_m;
        const double x = wall.x0_m - from.x_m, y = wall.y0_m - from.y_m, det = s * dx - c * dy;
        if (det == 0) continue;
        const double along = (y * dx - x * dy) / det, on = (c * y - s * x) / det;
        if (along > 0 && on >= 0 && on <= 1) nearest = std::min(nearest, along);
      }
      const double noise_m = rng != nullptr ? sd_m * rng->Normal() : 0;
      range_m.push_back(nearest < kReach_m ? nearest + noise_m : std::numeric_limits<double>::quiet_NaN());
    }
    return range_m;
  }
};

}  // namespace cairn::datasets
