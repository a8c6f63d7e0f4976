// What the result of local_map is made of.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pipelines/local_map/path/pairs.h"
#include "pipelines/local_map/path/runs.h"

namespace cairn::local_map {

// A loop: a node that was matched with a trace.
struct Loop {
  std::size_t node = 0;   // of whose surroundings
  std::size_t trace = 0;  // on which
  Position at;            // where it was found there; NaN: not told
  double quality = 0;
  bool used = false;
};

// `scans` are those of the optimized path.
struct Parts {
  std::vector<std::vector<Scan>> scans;  // [robots]
  std::vector<RecordedTrace> traces;
  std::vector<PathNode> nodes;
  std::vector<Loop> loops;
};

// The trace of this robot during which the scan was, or the last that began before it; -1: none.
std::int32_t TraceAt(const Parts& parts, std::size_t robot, std::size_t scan);

// Where a trace's frame lies in the world frame: its way's nodes are off their dead reckoning by so much
// on average.
Point MovedBy(const RecordedTrace& trace, const std::vector<PathNode>& nodes);

// Where the traces have edges of what is occupied, in the world frame.
std::vector<Point> EdgesOf(const std::vector<RecordedTrace>& traces, const std::vector<PathNode>& nodes);

}  // namespace cairn::local_map
