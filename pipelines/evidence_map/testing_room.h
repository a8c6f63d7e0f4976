// A log of a robot that drives through a room of 4 by 3 m, from (1, 1.5) to (3, 1.5) along its middle, and
// measures its walls without error.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "schema/blob.h"

namespace cairn::evidence_map {

struct Room {
  std::string kind = "laser";
  int scans = 20;
  bool drives = true;

  // From inside, along a ray.
  static double WallM(double x, double y, double heading_rad) {
    const double c = std::cos(heading_rad), s = std::sin(heading_rad);
    const double none = std::numeric_limits<double>::infinity();
    const double side = c > 0 ? (4 - x) / c : c < 0 ? -x / c : none;
    return std::min(side, s > 0 ? (3 - y) / s : s < 0 ? -y / s : none);
  }

  Blob Log() const {
    const int beams = kind == "laser" ? 180 : 24;
    const double opening_rad = kind == "laser" ? 0 : 0.2618;
    std::vector<double> time, x, y, heading, beam_heading, range;
    for (int b = 0; b < beams; ++b)
      beam_heading.push_back(std::remainder(b * 2 * std::numbers::pi / beams, 6.283));
    for (int s = 0; s < scans; ++s) {
      time.push_back(s);
      x.push_back(drives ? 1 + 2.0 * s / scans : 1);
      y.push_back(1.5);
      heading.push_back(0);
      for (const double at : beam_heading) {
        double nearest_m = WallM(x.back(), 1.5, at);
        const int sides = opening_rad > 0 ? 4 : 0;
        for (int k = -sides; k <= sides; ++k)
          nearest_m = std::min(nearest_m, WallM(x.back(), 1.5, at + k * opening_rad / 8));
        range.push_back(nearest_m);
      }
    }
    Blob log;
    log.Put("robots", Array::Texts({"ann"}));
    const std::string poses = "robot/0/poses/", sensor = "robot/0/" + kind + "/";
    log.PutVector(poses + "time_s", time);
    log.PutVector(poses + "x_m", x);
    log.PutVector(poses + "y_m", y);
    log.PutVector(poses + "heading_rad", heading);
    log.PutVector(sensor + "time_s", time);
    log.Put(sensor + "range_m", Array::Of<double>({scans, beams}, range));
    const std::vector<double> zero(static_cast<std::size_t>(beams), 0.0);
    log.PutVector(sensor + "beam_x_m", zero);
    log.PutVector(sensor + "beam_y_m", zero);
    log.PutVector(sensor + "beam_heading_rad", beam_heading);
    log.PutScalar(sensor + "opening_rad", opening_rad);
    log.PutScalar(sensor + "max_range_m", 8.0);
    return log;
  }
};

}  // namespace cairn::evidence_map
