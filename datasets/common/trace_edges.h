// The walls of a `local_map`, as points.
#pragma once

#include <vector>

#include "schema/blob.h"
#include "schema/geometry.h"

namespace cairn::datasets {

// Of each robot, in its map's frame: the middles of edges that traces found occupied. Empty where the result
// has no traces.
std::vector<std::vector<Point>> TraceEdges(const Blob& result);

}  // namespace cairn::datasets
