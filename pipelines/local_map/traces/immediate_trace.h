// What the local grids hold around the robot, in the format of a trace ([DM98] section 4.1).
#pragma once

#include "pipelines/local_map/grids/local_grids.h"
#include "pipelines/local_map/traces/edge_trace.h"
#include "pipelines/local_map/traces/frame.h"

namespace cairn::local_map {

// The feature of one column of cells: on each side of the z axis the nearest edges along the way, or, where
// there are none, the nearest ones across it. `z` counts in `frame`.
Feature ColumnOf(const LocalGrids& grids, const TraceFrame& frame, int z);

// Makes the trace of a way in direction `quarter` through the middle of the central cell. `trace` keeps its
// memory from call to call: none is taken once it has had 2 half + 1 features.
void MakeImmediate(const LocalGrids& grids, int quarter, ImmediateTrace& trace);

// Room for the immediate traces of such grids.
ImmediateTrace ImmediateRoom(const LocalGrids& grids);

}  // namespace cairn::local_map
