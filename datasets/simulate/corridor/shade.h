// The colour of what a ray hits.
#pragma once

#include <vector>

#include "datasets/simulate/corridor/scene.h"

namespace cairn::datasets::corridor {

class Shade {
 public:
  explicit Shade(const Scene& scene);

  // As the camera gets it, before noise; may be above 1.
  Rgb operator()(const Hit& hit) const;
  // Whether a point of the ceiling is of a lamp that is on.
  bool IsLight(const Vec3& at) const;

 private:
  double LightAt(double x_m) const;
  Rgb Wall(const Hit& hit) const;
  Rgb Panel(const Hit& hit) const;
  Rgb Door(const Hit& hit) const;
  Rgb Within(const Hit& hit) const;
  Rgb Ceiling(const Vec3& at) const;
  Rgb Floor(const Vec3& at) const;
  Rgb Person(const Hit& hit) const;
  Rgb Lit(const Rgb& colour, const Vec3& at) const;
  int LampAt(const Vec3& at) const;  // -1: none

  const Scene* scene_;
  std::vector<double> light_;  // along x, every kLightStepM from -kCornerM on
};

}  // namespace cairn::datasets::corridor
