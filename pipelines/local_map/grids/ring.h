// A ring of range sensors whose heading is independent of the base's: on a turret ([DM98] section 2).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pipelines/local_map/grids/plane.h"
#include "schema/geometry.h"

namespace cairn::local_map {

// What one ring measured at one time. A NaN is a sensor that is missing or without an answer; no ranges at
// all: the ring was not read this time.
struct RingScan {
  double time_s = 0;
  double turret_rad = 0;            // heading of the turret on the robot
  std::span<const double> range_m;  // one a beam
};

class SensorRing {
 public:
  // `beams`: where each begins and points on the turret, whose axis is the robot's centre; in the order in
  // which they stand. `opening_rad`: of a beam's cone, in full; 0: a ray. Ranges beyond `max_range_m` are no
  // hits. `sectors`: a laser is thinned to so many neighbouring groups of beams, of each of which the nearest
  // reading counts; 0: every beam is one.
  SensorRing(const std::vector<Pose>& beams, double opening_rad, double max_range_m, int sectors = 0);

  std::size_t beams() const { return beams_.size(); }
  // The most hits of a scan.
  std::size_t sectors() const { return first_beam_.size() - 1; }
  // Whether the last beam is a neighbour of the first.
  bool closed() const { return closed_; }

  // Writes the hits of a scan in the order of the beams, with `robot` in the frame in which they are wanted;
  // returns how many. `hits` has room for sectors().
  std::size_t Hits(const Pose& robot, const RingScan& scan, std::span<Point> hits) const;

 private:
  struct Beam {
    double x_m, y_m, cos, sin;  // on the turret
    double ahead_m;             // by which it begins beyond the turret's axis
    double next_rad;            // to the next beam
  };
  double RangeM(const RingScan& scan, std::size_t beam) const;
  double Aside(const RingScan& scan, std::size_t beam) const;
  std::size_t Nearest(const RingScan& scan, std::size_t sector) const;

  std::vector<Beam> beams_;
  std::vector<std::size_t> first_beam_;  // [sectors + 1]
  double half_opening_, max_range_m_;
  bool closed_;
};

}  // namespace cairn::local_map
