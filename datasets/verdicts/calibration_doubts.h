// What odometry and sensors of a landmark map's robots err by all along, where that makes a map doubtful.
#pragma once

#include "datasets/verdicts/verdict.h"
#include "schema/kinds/landmark_map.h"

namespace cairn::datasets {

// Each adds the number that it rests on to the verdict's: of the robot that errs most.
Verdict::Doubt OfDistances(const kinds::LandmarkMap& map, Verdict* verdict);
Verdict::Doubt OfTurns(const kinds::LandmarkMap& map, Verdict* verdict);
Verdict::Doubt OfRangeOffsets(const kinds::LandmarkMap& map, Verdict* verdict);
Verdict::Doubt OfClocks(const kinds::LandmarkMap& map, Verdict* verdict);
Verdict::Doubt OfMounts(const kinds::LandmarkMap& map, Verdict* verdict);

}  // namespace cairn::datasets
