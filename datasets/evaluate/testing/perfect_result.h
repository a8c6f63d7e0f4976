// The result that the best of all pipelines would give: for tests, and to try tools on.
#pragma once

#include "schema/blob.h"

namespace cairn::datasets {

// A `landmark_map` made of a log's truth alone: the true poses, the true landmarks that the true associations
// name, those associations. It has no grid. Poses of robots without true poses are empty.
// Throws InputError where the log has no true landmarks, or no true associations of a robot that observed
// any.
Blob PerfectLandmarkMap(const Blob& truth_log);

}  // namespace cairn::datasets
