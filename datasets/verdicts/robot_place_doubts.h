// What a landmark_map of several robots says against where each of them lies in the map of the others.
#pragma once

#include "datasets/verdicts/verdict.h"
#include "schema/kinds/landmark_map.h"

namespace cairn::datasets {

// Whether names, or enough landmarks in common, say where each robot is in the map of the others.
Verdict::Doubt OfPlaces(const kinds::LandmarkMap& map, Verdict* verdict);

// A few landmarks in common may lie upon one another by chance. The ratio of right to chance is that of the
// word: of ten maps of 1 to 9, of a hundred of 1 to 99.
Verdict::Doubt OfChance(const kinds::LandmarkMap& map, Verdict* verdict);

// Of robots that are tied: a sensor that errs by a factor makes landmarks of its own, beside those of the
// others, who looked there and saw none. They take up what does not fit, and nothing else says so.
Verdict::Doubt OfOneSided(const kinds::LandmarkMap& map, Verdict* verdict);

}  // namespace cairn::datasets
