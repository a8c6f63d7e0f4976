// A room with a box in it, scanned by a robot that drives through, for tests.
#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "pipelines/common/range_scans.h"
#include "pipelines/forward_map/map_state.h"
#include "schema/blob.h"
#include "schema/rng.h"

namespace cairn::forward_map {

// Walls at x = 0 and x = width_m, y = 0 and y = depth_m; the box has sides of 1 m and its corner at (2, 2).
struct Room {
  double width_m = 6, depth_m = 5;
  int scans = 30;
  int beams = 24;
  double opening_rad = 0;
  double max_range_m = 4;  // so that some beams have no echo
  double sigma_m = 0.02;
  double random_share = 0.02;
  // Somebody stands at (4.5, 1) during these scans.
  int person_from = 0, person_until = 0;
  std::uint64_t seed = 1;

  // A log with the path and the scans of one sensor, sonar where it has an opening.
  Blob Log() const {
    const std::string name = opening_rad > 0 ? "robot/0/sonar/" : "robot/0/laser/";
    Rng rng(seed, 5);
    std::vector<double> time_s, x, y, heading, range, zero(static_cast<std::size_t>(beams)), direction;
    for (int b = 0; b < beams; ++b) direction.push_back(2 * M_PI * b / beams);
    for (int s = 0; s < scans; ++s) {
      const double turn = 2 * M_PI * s / scans;
      time_s.push_back(s);
      x.push_back(width_m / 2 + (width_m / 2 - 0.8) * std::cos(turn));
      y.push_back(depth_m / 2 + (depth_m / 2 - 0.8) * std::sin(turn));
      heading.push_back(turn / 3);
      for (const double d : direction)
        range.push_back(Measure(s, x.back(), y.back(), heading.back() + d, rng));
    }
    Blob log;
    log.Put("robots", Array::Texts({"rover"}));
    log.PutVector("robot/0/poses/time_s", time_s);
    log.PutVector("robot/0/poses/x_m", x);
    log.PutVector("robot/0/poses/y_m", y);
    log.PutVector("robot/0/poses/heading_rad", heading);
    log.PutVector(name + "time_s", time_s);
    log.Put(name + "range_m", Array::Of<double>({scans, beams}, range));
    log.PutVector(name + "beam_x_m", zero);
    log.PutVector(name + "beam_y_m", zero);
    log.PutVector(name + "beam_heading_rad", direction);
    log.PutScalar(name + "opening_rad", opening_rad);
    log.PutScalar(name + "max_range_m", max_range_m);
    return log;
  }

  std::vector<RangeScans> Sensors() const { return ReadRangeScans(Log(), nullptr, {}).sensors; }

  MapState EmptyMap(double cell_m) const {
    GridOptions options;
    options.cell_m = cell_m;
    MapState map{GridOf(ReadRangeScans(Log(), nullptr, options), options, 64), {}, {}};
    map.occupied.resize(static_cast<std::size_t>(map.box.cells()));
    map.models = {{.sigma_m = cell_m / 2, .no_echo_m = cell_m / 2, .z_max_m = max_range_m}};
    return map;
  }

 private:
  // The nearest of what stands there, over the cone's rays.
  double Measure(int scan, double x, double y, double heading, Rng& rng) const {
    double nearest = std::numeric_limits<double>::infinity();
    const int rays = opening_rad > 0 ? 9 : 1;
    for (int r = 0; r < rays; ++r) {
      const double off = rays == 1 ? 0 : opening_rad * (static_cast<double>(r) / (rays - 1) - 0.5);
      nearest = std::min(nearest, Along(scan, x, y, heading + off));
    }
    if (rng.Uniform() < random_share) return rng.Uniform(0, max_range_m);
    nearest = std::max(0.0, nearest + sigma_m * rng.Normal());
    return nearest <= max_range_m ? nearest : std::numeric_limits<double>::quiet_NaN();
  }

  double Along(int scan, double x, double y, double heading) const {
    constexpr double kStep_m = 0.005;
    const double dx = std::cos(heading), dy = std::sin(heading);
    for (double at = 0; at < max_range_m + 1; at += kStep_m) {
      const double px = x + at * dx, py = y + at * dy;
      const bool wall = px <= 0 || px >= width_m || py <= 0 || py >= depth_m;
      const bool box = px >= 2 && px <= 3 && py >= 2 && py <= 3;
      const bool person = scan >= person_from && scan < person_until && std::hypot(px - 4.5, py - 1) < 0.2;
      if (wall || box || person) return at;
    }
    return max_range_m + 1;
  }
};

}  // namespace cairn::forward_map
