// What a landmark_map says against the odometry that it rests on: where it broke, where all hangs by it,
// where it is not there.
#pragma once

#include "datasets/verdicts/verdict.h"
#include "schema/kinds/landmark_map.h"

namespace cairn::datasets {

// Names hold a map together where its odometry broke. Without any, what is seen after a slip becomes
// landmarks of its own beside those seen before, which fit as well as right ones do.
Verdict::Doubt OfJumps(const kinds::LandmarkMap& map);

// A slip of odometry between two halves that share no landmark moves one of them, and nothing else says so.
Verdict::Doubt OfHalves(const kinds::LandmarkMap::Fit& fit);

// Time that the log lacks, and the way in it.
Verdict::Doubt OfHoles(const kinds::LandmarkMap& map, Verdict* verdict);

}  // namespace cairn::datasets
