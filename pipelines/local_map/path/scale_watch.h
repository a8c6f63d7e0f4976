// How long odometry's metre is, by walls that the robot drives straight up to or away from: the distance to
// them shrinks or grows by what was truly driven. Loops cannot tell it, as a map that is too large closes
// too.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "pipelines/local_map/grids/ring.h"
#include "schema/geometry.h"

namespace cairn::local_map {

// One drive before one wall: sums over its scans, about their means, of the distance along its direction
// squared and of that times the distance to the wall.
struct Approach {
  double along2_m2 = 0, along_distance_m2 = 0;
  double sd = 0;          // of the scale that it tells, by how far its scans lie off a straight line
  std::int64_t scan = 0;  // amid it
  double Scale() const { return -along_distance_m2 / along2_m2; }
  static void Fields(const auto& field) {
    field("along2_m2", &Approach::along2_m2);
    field("along_distance_m2", &Approach::along_distance_m2);
    field("sd", &Approach::sd);
    field("scan", &Approach::scan);
  }
};

class ScaleWatch {
 public:
  struct Ring {
    std::vector<Pose> beams;
    double opening_rad = 0, max_range_m = 0;
  };
  // What is looked at: walls along the axes, whose frame the poses are in, by a robot whose metre is nearly
  // one; or whatever lies straight ahead of or behind a laser, in any frame, by one whose metre may be 0.3
  // or 3.
  enum class Towards { kAxes, kAhead };
  explicit ScaleWatch(std::vector<Ring> rings, Towards towards = Towards::kAxes);

  // Scan number `scan`.
  void Update(std::int64_t scan, const Pose& pose, std::span<const RingScan> scans);
  // Ends all drives, as where odometry is cut.
  void Finish();

  const std::vector<Approach>& approaches() const { return approaches_; }

 private:
  struct Drive {
    double direction_rad = 0;
    std::vector<double> along_m, distance_m;
    std::vector<std::int64_t> scan;
    double aside_m = 0;  // of its first scan
  };
  std::optional<double> DistanceTo(double direction_rad, const Pose& pose,
                                   std::span<const RingScan> scans) const;
  bool GoesOn(const Drive& drive, double along_m, double aside_m, double distance_m) const;
  void Close(Drive* drive);

  std::vector<Ring> rings_;
  Towards towards_;
  std::vector<Drive> drives_;
  std::vector<Approach> approaches_;
};

// True way / odometry's: least squares over the approaches that tell about the same, with 1 as sure as
// odometers usually are; 1 where there are too few.
double FitScale(const std::vector<Approach>& approaches);

}  // namespace cairn::local_map
