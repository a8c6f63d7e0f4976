// What a sonar hears: the nearest thing in its cone that answers it. A mirror for sound does so where it is
// faced, a plain wall the less the more obliquely it is met.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "datasets/common/walls.h"
#include "datasets/simulate/sonar.h"
#include "schema/geometry.h"
#include "schema/rng.h"

namespace cairn::datasets {

// truth/robot/N/sonar/cause (schema/FORMAT.md).
enum class Cause : std::uint8_t { kNothing = 0, kWall = 1, kBeyondDoor = 2, kPerson = 3, kMirror = 4 };

struct Sounding {
  double range_m = 0;  // NaN: no echo
  Cause cause = Cause::kNothing;
};

// The chances of one reading: drawn before it is known what there is to hear, so that a hall with its door
// closed is heard by the same luck.
struct Luck {
  double noise_m = 0;
  bool lost = false;                         // no echo, but from beyond a door: those readings are counted
  double mirror = 0, late = 0, oblique = 0;  // in [0, 1)
};
// `oblique` stays 0: every plain wall answers.
Luck DrawLuck(const RangeRing& ring, Rng& rng);

enum class Surface { kRough, kPlain, kMirror, kBeyondDoor };
struct Obstacle {
  Wall wall;
  Surface surface = Surface::kRough;
};

// What becomes of sound that does not face a mirror: some of it is answered all the same. What is thrown on
// is lost, or the echo of what the mirror shows returns, or one of many later ones does, from anywhere up to
// the sonar's reach.
inline constexpr double kMirrorAnswers = 0.35, kMirrorLost = 0.25, kMirrorEcho = 0.15;  // the rest is late
// A plain wall that is met at the angle a from its perpendicular answers with probability exp(-(a/this)²/2).
inline constexpr double kPlainRad = 0.35;
inline constexpr double kPersonRadiusM = 0.25;

// One beam of a ring whose centre and heading are `ring_pose`. A mirror answers where its foot of the
// perpendicular lies in the cone; else most of the sound that hits it along the beam's axis is thrown on.
// Nothing is heard through a wall. To rings without sound all surfaces are rough.
Sounding Listen(const std::vector<Obstacle>& around, const RangeRing& ring, const Pose& ring_pose, int beam,
                std::span<const Point> persons, const Luck& luck);

}  // namespace cairn::datasets
