// What a robot on a drive senses of landmarks: buttons that it contact detections where it stands, or ranges
// and bearings; with false and missed ones, types that are mistaken for one another, identities.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "datasets/common/walls.h"
#include "datasets/simulate/drive.h"
#include "schema/blob.h"

namespace cairn::datasets {

// The sensor for ranges and bearings: an image a metre travelled, of what is in view and behind no wall.
inline constexpr double kCameraMaxRangeM = 10, kCameraViewRad = 2.0944;     // 120 degrees
inline constexpr double kCameraRangeSdM = 0.1, kCameraBearingSdRad = 0.03;  // sd of its errors
// A false contact detection nearer to a landmark than this would be one of it.
inline constexpr double kFalseContactClearanceM = 4;
// Of the passes of a landmark that a drive leaves without a contact detection.
inline constexpr double kDriveMissRate = 0.03;

struct LoopSensing {
  std::string sensor = "contact";     // or "range-bearing"
  double false_rate = 0;              // share of the observations that are false, 0 to 0.5
  double miss_rate = kDriveMissRate;  // of the landmarks passed, or in view; from 0.03 to 0.9
  int types = 1;                      // classes of landmarks that look different, 1 to 16
  double confusion = 0;               // probability that a landmark is taken for one of another type
  bool identities = false;            // observations say which landmark; not with several types

  bool ranged() const { return sensor == "range-bearing"; }
  bool operator==(const LoopSensing&) const = default;
};

// Throws InputError for what is out of range.
void Check(const LoopSensing& sensing);

struct Sensed {
  std::size_t control = 0;              // at the end of which
  std::int32_t landmark = -1;           // of the world; -1: a false one
  std::int32_t type = 0;                // as it seemed
  std::int32_t identity = -1;           // as it seemed; -1: not told
  double range_m = 0, bearing_rad = 0;  // NaN: a contact detection
};

// In order of time. `types`: of the world's landmarks. Draws nothing for contact detections without false or
// further missed ones, of one type.
std::vector<Sensed> Sense(const Drive& drive, const CorridorWorld& world, const std::vector<int>& types,
                          const LoopSensing& sensing, Rng& rng);

}  // namespace cairn::datasets
