// A log of a robot that drives through a room with a box in it and scans it, for tests.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "schema/blob.h"
#include "schema/error.h"
#include "schema/kinds/local_map.h"
#include "schema/rng.h"

namespace cairn {

// Walls at x = 0 and x = width_m, y = 0 and y = depth_m; the box has sides of 1 m and its corner at (2, 2).
// The robot goes round it once, 0.8 m from the walls where it is nearest to them.
struct Room {
  double width_m = 6, depth_m = 5;
  int scans = 30;
  int beams = 24;          // all around
  double opening_rad = 0;  // above 0: sonar
  double max_range_m = 4;  // so that some beams have no echo
  double sigma_m = 0.02;
  double random_share = 0.02;
  // Somebody stands at (4.5, 1) during these scans.
  int person_from = 0, person_until = 0;
  bool drives = true;  // false: it stays where it begins
  std::uint64_t seed = 1;

  // A log with the path and the scans of one sensor.
  Blob Log() const {
    Rng rng(seed, 5);
    std::vector<double> time_s, x, y, heading, range, direction;
    for (int b = 0; b < beams; ++b)
      direction.push_back(std::remainder(2 * std::numbers::pi * b / beams, 2 * std::numbers::pi));
    for (int s = 0; s < scans; ++s) {
      const double turn = drives ? 2 * std::numbers::pi * s / scans : 0;
      time_s.push_back(s);
      x.push_back(width_m / 2 + (width_m / 2 - 0.8) * std::cos(turn));
      y.push_back(depth_m / 2 + (depth_m / 2 - 0.8) * std::sin(turn));
      heading.push_back(turn / 3);
      for (const double d : direction)
        range.push_back(Measure(s, x.back(), y.back(), heading.back() + d, rng));
    }
    const std::vector<double> zero(direction.size());
    const std::string poses = "robot/0/poses/",
                      sensor = opening_rad > 0 ? "robot/0/sonar/" : "robot/0/laser/";
    Blob log;
    log.Put("robots", Array::Texts({"rover"}));
    log.PutVector(poses + "time_s", time_s);
    log.PutVector(poses + "x_m", x);
    log.PutVector(poses + "y_m", y);
    log.PutVector(poses + "heading_rad", heading);
    log.PutVector(sensor + "time_s", time_s);
    log.Put(sensor + "range_m", Array::Of<double>({scans, beams}, range));
    log.PutVector(sensor + "beam_x_m", zero);
    log.PutVector(sensor + "beam_y_m", zero);
    log.PutVector(sensor + "beam_heading_rad", direction);
    log.PutScalar(sensor + "opening_rad", opening_rad);
    log.PutScalar(sensor + "max_range_m", max_range_m);
    return log;
  }

 private:
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  // The nearest of what stands there, over the cone's rays.
  double Measure(int scan, double x, double y, double heading, Rng& rng) const {
    double nearest_m = kNever;
    const int rays = opening_rad > 0 ? 9 : 1;
    for (int r = 0; r < rays; ++r) {
      const double off = rays == 1 ? 0 : opening_rad * (static_cast<double>(r) / (rays - 1) - 0.5);
      nearest_m = std::min(nearest_m, Along(scan, x, y, heading + off));
    }
    if (rng.Uniform() < random_share) return rng.Uniform(0, max_range_m);
    nearest_m = std::max(0.0, nearest_m + sigma_m * rng.Normal());
    return nearest_m <= max_range_m ? nearest_m : std::numeric_limits<double>::quiet_NaN();
  }

  double Along(int scan, double x, double y, double heading) const {
    const double ux = std::cos(heading), uy = std::sin(heading);
    const auto to_wall = [](double at, double u, double far) {
      return u > 0 ? (far - at) / u : u < 0 ? -at / u : kNever;
    };
    double nearest_m = std::min(to_wall(x, ux, width_m), to_wall(y, uy, depth_m));
    nearest_m = std::min(nearest_m, ToBox(x, y, ux, uy));
    if (scan >= person_from && scan < person_until) nearest_m = std::min(nearest_m, ToPerson(x, y, ux, uy));
    return nearest_m;
  }

  static double ToBox(double x, double y, double ux, double uy) {
    const double a = (2 - x) / ux, b = (3 - x) / ux, c = (2 - y) / uy, d = (3 - y) / uy;
    const double enter_m = std::max(std::min(a, b), std::min(c, d));
    const double leave_m = std::min(std::max(a, b), std::max(c, d));
    return enter_m > 0 && enter_m < leave_m ? enter_m : kNever;
  }

  static double ToPerson(double x, double y, double ux, double uy) {
    constexpr double kRadius_m = 0.2;
    const double along_m = (4.5 - x) * ux + (1 - y) * uy, across_m = (4.5 - x) * uy - (1 - y) * ux;
    if (along_m <= 0 || std::abs(across_m) >= kRadius_m) return kNever;
    return along_m - std::sqrt(kRadius_m * kRadius_m - across_m * across_m);
  }
};

// Robots "rover" and "other", of a room each, and their paths as those of a local_map, which has a frame for
// each.
inline Blob LogOfTwoRovers(const Room& room, const Room& other) {
  Blob log = room.Log();
  log.Put("robots", Array::Texts({"rover", "other"}));
  log.PutAll("robot/1/", other.Log().Sub("robot/0/"));
  return log;
}
inline Blob LocalPathsOf(const Blob& log) {
  Blob paths;
  paths.Put("robots", log.at("robots"));
  for (const char* robot : {"robot/0/poses/", "robot/1/poses/"}) paths.PutAll(robot, log.Sub(robot));
  kinds::LocalMap::Traces none;
  none.robot = none.first_z = std::vector<std::int32_t>{};
  none.first_s = none.last_s = none.x_m = none.y_m = none.direction_rad = std::vector<double>{};
  none.features = std::vector<std::int64_t>{};
  PutFields("traces/", none, &paths);
  return paths;
}

// Laid over each other they look like a map. `map`: makes one of the robots of these names, all where empty.
template <class Map>
void ExpectTwoFramesAreRefused(const Map& map) {
  for (const char* both : {"", "rover,other"}) {
    try {
      map(both);
      ADD_FAILURE() << both;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("'rover', 'other' have a frame each"), std::string::npos)
          << error.what();
    }
  }
}

}  // namespace cairn
