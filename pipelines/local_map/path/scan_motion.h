// How a robot moved between two scans of its laser, as the walls that both show say: they stand still.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pipelines/local_map/grids/ring.h"
#include "schema/geometry.h"

namespace cairn::local_map {

inline constexpr std::size_t kDirections = 720;  // half degrees, from -pi on
std::size_t DirectionOf(double angle_rad);       // of an angle in [-pi, pi]

// What one scan of a laser showed, in the robot's frame.
struct LaserView {
  Point origin;             // of the beams
  std::vector<Point> hits;  // one a beam; NaN: none
  std::vector<Point> some;  // of them that are hits, spread over the scan
  std::span<const std::int16_t>
      beam_at;  // of each half degree from -pi on the beam that points there; -1: none
  // It looks from the first beam with a hit to the last and so far: a fan may be masked at its sides.
  std::size_t first_beam = 0, last_beam = 0;
  double max_range_m = 0;
  double one_wall_ratio = 0;  // of a range: neighbouring hits no further apart are of one wall
};

// A laser's beams, which begin at about one point.
class LaserFan {
 public:
  LaserFan(std::vector<Pose> beams, double max_range_m);
  LaserView View(const RingScan& scan) const;  // lives no longer than the fan

 private:
  std::vector<Pose> beams_;
  double max_range_m_, one_wall_ratio_ = 0;
  std::vector<std::int16_t> beam_at_;
};

// A motion, of the robot in its frame at the first of two views, and the share of the second's hits that lie
// then where the first saw something; of those in directions in which the first looked.
struct ScanMotion {
  Pose moved;
  double share = 0, tells = 0;  // `tells`: how many hits the share is of, half of all at least
  double looked = 0;            // how many of them lie in such directions
  double in_view = 0;           // the share of all hits that lie where the first view looks
};

// How well that motion explains the second view.
ScanMotion WeighMotion(const LaserView& from, const LaserView& to, const Pose& moved);

// The best near `odometry`, whose clock may run otherwise than the laser's; itself, where that explains such
// a share.
ScanMotion NearOdometry(const LaserView& from, const LaserView& to, const Pose& odometry, double explained);

// The best of all: any turn up to `most_rad`, and ways of up to `most_m` more or less than odometry's.
ScanMotion AnyMotion(const LaserView& from, const LaserView& to, const Pose& odometry, double most_rad,
                     double most_m);

}  // namespace cairn::local_map
