// Landmarks of a landmark_map that rest on one observation: nothing confirms them. A false observation makes
// such a landmark, too, and most logs do not state how many are false.
#pragma once

#include <cstddef>

#include "datasets/verdicts/verdict.h"
#include "schema/kinds/landmark_map.h"

namespace cairn::datasets {

struct SeenOnce {
  std::size_t landmarks = 0;  // of the map
  std::size_t once = 0;       // of them, observed once
  // Of those, where a robot passed again and observed nothing; where it is not known when a landmark was
  // passed, none.
  std::size_t passed_again = 0;
};
SeenOnce CountSeenOnce(const kinds::LandmarkMap& map);

// Of contact detections that are seen once and passed again the map is fair at most, and low where they are
// more than a fifth of the landmarks: of simulated logs in which one in fifty is false, and which do not say
// so, these tell nearly all (pipelines/landmark_map/EXPERIMENTS.md, "False observations"). Else it is fair
// where more than a tenth are seen once by a sensor that sees landmarks at a distance, for others are seen
// in row upon row.
Verdict::Doubt OfSeenOnce(const SeenOnce& seen, bool at_a_distance);

}  // namespace cairn::datasets
