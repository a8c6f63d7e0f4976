// Sensors that err more than the log of a landmark_map states, or than was expected.
#pragma once

#include "datasets/verdicts/verdict.h"
#include "schema/kinds/landmark_map.h"

namespace cairn::datasets {

// Widths estimated from the residuals that are far from what was stated of a sensor, by half, or, where
// nothing was, from what was expected, by two. Where nothing names the landmarks the map may explain each of
// them by a landmark of its own; where all have names, nothing is stated, and errors do not go on from one
// sighting to the next, the sensor is coarse and the map as good as it says. `one_moves`: most misfits are of
// one landmark, which tells why.
Verdict::Doubt OfWidths(const kinds::LandmarkMap::Fit& fit, bool all_named, bool one_moves);

// Where not all landmarks have names and a sensor errs by half more than stated or expected, what it says of
// many observations that they are none may be of the right ones: low where more than a fifth are of no
// landmark, unless the log states that so many are false. Where less was left out than is false, false ones
// are in the map.
Verdict::Doubt OfMuchLeftOut(const kinds::LandmarkMap::Fit& fit, bool all_named, double explained_share);

}  // namespace cairn::datasets
