// What a sonar hears in a hall: the nearest thing in its cone, but of a smooth wall only where it faces it.
#pragma once

#include <cstdint>
#include <optional>

#include "datasets/hall/world.h"
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
  bool lost = false;            // no echo, but from beyond a door: those readings are counted
  double mirror = 0, late = 0;  // in [0, 1)
};
Luck DrawLuck(Rng& rng);

// What becomes of sound that does not face a mirror: some of it is answered all the same. What is thrown on
// is lost, or the echo of what the mirror shows returns, or one of many later ones does, from anywhere up to
// the sonar's reach.
inline constexpr double kMirrorAnswers = 0.35, kMirrorLost = 0.25, kMirrorEcho = 0.15;  // the rest is late
inline constexpr double kPersonRadiusM = 0.25;

// A beam of simulate_sonar.h's ring. A smooth wall answers where its foot of the perpendicular lies in the
// cone; else most of the sound that hits it along the beam's axis goes on as from a mirror.
Sounding Listen(const Hall& hall, const PoseM& robot, int beam, const std::optional<PointM>& person,
                const Luck& luck);

}  // namespace cairn::datasets
