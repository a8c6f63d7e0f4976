// Landmarks of a landmark_map without names that a robot saw only before, or only after, one moment, though
// it looked at their places on both sides of it: those of one side are ghosts of the other's.
#pragma once

#include "datasets/verdicts/verdict.h"
#include "schema/kinds/landmark_map.h"

namespace cairn::datasets {

// Low where there are three such landmarks or more, and more than twice as many as those seen on both sides
// (`fit/one_sided`, `fit/two_sided`): of simulated halls in which odometry slips once these tell the maps
// that are wrong (pipelines/landmark_map/EXPERIMENTS.md, "A slip without names"). Names tell for themselves.
Verdict::Doubt OfLandmarksOnOneSide(const kinds::LandmarkMap& map, Verdict* verdict);

// Low where at some moment, but for the first and the last tenth of its observations, no more than half of
// the landmarks that a robot had seen before, or, where they are fewer, that it saw after, were seen on both
// sides (schema/kinds/few_in_common.h), unless these tie both sides (`fit/few_common_lead_nats`). Whoever
// drives to and fro among his landmarks sees most of them again. Not where all have names.
Verdict::Doubt OfFewInCommon(const kinds::LandmarkMap& map, Verdict* verdict);

}  // namespace cairn::datasets
