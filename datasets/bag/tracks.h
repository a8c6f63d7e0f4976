// Paths that bags hold several of: those of tf, set together, and odometries, held against each other.
#pragma once

#include <string>
#include <vector>

#include "datasets/bag/readers.h"
#include "datasets/import/log_rows.h"

namespace cairn::datasets::bag {

// Where `base` was on a frame called map by tf: that of the odometry's frame on the map, between two of its
// times in between, and the robot's on odometry, at whose times the poses are. Nothing where two transforms
// of the map are more than a second apart, or before the first and after the last. Of several robots frames
// that begin with `robot` count, where there are any. Throws InputError, which begins with `whose`, where tf
// has no such frames.
SpooledRows<PoseRow> PosesOnMap(const FrameTree& frames, const std::string& robot, const std::string& base,
                                const std::string& whose, ImportReport* report);

// Of two odometries, with their names for people: warns where they differ, over the time that both cover, by
// more than a tenth in the distance travelled, or in how far they turned.
void CompareOdometries(const std::string& one, const SpooledRows<PoseRow>& ones, const std::string& other,
                       const SpooledRows<PoseRow>& others, ImportReport* report);

}  // namespace cairn::datasets::bag
