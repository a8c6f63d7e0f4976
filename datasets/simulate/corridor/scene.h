// What a ray hits in the corridor on a given day: for the camera and for sonars alike.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "datasets/simulate/corridor/run.h"
#include "datasets/simulate/corridor/world.h"

namespace cairn::datasets::corridor {

struct Vec3 {
  double x = 0, y = 0, z = 0;
};

enum class Surface : std::uint8_t {
  kWall,    // index: Side
  kPanel,   // index: of `side`'s panels
  kDoor,    // a closed one; index: of `side`'s openings
  kWithin,  // of an opening that one can look into; index as of a door
  kReveal,  // the cut through the wall beside a closed door
  kFloor,
  kCeiling,
  kEnd,
  kPerson,
  kBin,  // index: of the run's
};

struct Hit {
  double distance = 0;  // in lengths of the ray's direction
  Vec3 at;
  Surface surface = Surface::kWall;
  Side side = kOuter;
  std::size_t index = 0;
};

// Upright cylinders.
struct Pillar {
  double x_m = 0, y_m = 0, radius_m = 0, height_m = 0;
  Surface surface = Surface::kPerson;
  std::size_t index = 0;
};

// Keeps references: world and run outlive it.
class Scene {
 public:
  Scene(const World& world, const Run& run);

  const World& world() const { return *world_; }
  const Run& run() const { return *run_; }

  // People and bins that are near x at that time.
  std::vector<Pillar> PillarsNear(double x_m, double time_s) const;
  // The nearest surface. `from` is within the corridor.
  Hit Cast(const Vec3& from, const Vec3& direction, const std::vector<Pillar>& pillars) const;
  bool IsOpen(Side side, std::size_t opening) const { return run_->open[side][opening]; }

 private:
  struct Bucket {
    std::vector<std::size_t> openings, panels;
  };
  const Bucket& BucketAt(Side side, double x_m) const;
  Hit CastAtWall(Side side, double distance, const Vec3& from, const Vec3& direction) const;
  Hit CastWithin(Side side, std::size_t opening, double distance, const Vec3& from,
                 const Vec3& direction) const;

  const World* world_;
  const Run* run_;
  std::array<std::vector<Bucket>, 2> buckets_;  // by Side: a metre each, from -kCornerM on
};

}  // namespace cairn::datasets::corridor
