// A local map as a graph: what its log's odometry, its walls and its loops say of the path.
#pragma once

#include <string>
#include <vector>

#include "datasets/export/parts.h"
#include "schema/kinds/local_map.h"
#include "schema/kinds/log.h"

namespace cairn::datasets {

// Of paths whose poses are vertices one after the other, from 0 on:
// - from each pose to the next one the log's odometry, in the metre that the path has on average, with the
//   heading that walls give it and the noise that local_map takes it to have (its options' defaults); across
//   a jump, and where a log has poses and no odometry, the path's own motion;
// - each loop that the path follows, where matching told.
// Throws InputError where the result is of another log.
std::string LocalMapEdges(const kinds::LocalMap& map, const kinds::Log& log, const std::vector<Path>& paths);

}  // namespace cairn::datasets
