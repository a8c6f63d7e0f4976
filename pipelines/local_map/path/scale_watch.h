// How long odometry's metre is, by walls that the robot drives straight up to or away from: the distance to
// them shrinks or grows by what was truly driven. Loops cannot tell it, as a map that is too large closes
// too.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "pipelines/local_map/grids/ring.h"
#include "schema/geometry.h"

namespace cairn::local_map {

// One drive before one wall: sums over its scans, about their means, of the distance along the axis squared
// and of that times the distance to the wall.
struct Approach {
  double along2_m2 = 0, along_distance_m2 = 0;
};

class ScaleWatch {
 public:
  struct Ring {
    std::vector<Pose> beams;
    double opening_rad = 0, max_range_m = 0;
  };
  explicit ScaleWatch(std::vector<Ring> rings) : rings_(std::move(rings)) {}

  // One scan at a pose in the frame of the walls.
  void Update(const Pose& pose, std::span<const RingScan> scans);
  // Ends all drives, as where odometry is cut.
  void Finish();

  const std::vector<Approach>& approaches() const { return approaches_; }

 private:
  struct Drive {
    std::vector<double> along_m, distance_m;
    double aside_m = 0;  // of its first scan
  };
  void Close(Drive* drive);

  std::vector<Ring> rings_;
  std::array<Drive, 4> drives_;  // towards each of the four directions
  std::vector<Approach> approaches_;
};

// True way / odometry's: least squares over the approaches that tell about the same, with 1 as sure as
// odometers usually are; 1 where there are too few.
double FitScale(const std::vector<Approach>& approaches);

}  // namespace cairn::local_map
