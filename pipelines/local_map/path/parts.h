// What the result of local_map is made of.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pipelines/local_map/path/pairs.h"
#include "pipelines/local_map/path/runs.h"

namespace cairn::local_map {

// A loop: a knot that was matched with a trace.
struct Loop {
  std::size_t knot = 0;   // of whose surroundings
  std::size_t trace = 0;  // on which
  Position at;            // where it was found there; NaN: not told
  double quality = 0;
  bool used = false;
};

// `sweeps` are those of the assembled path.
struct Parts {
  std::vector<std::vector<Sweep>> sweeps;  // [robots]
  std::vector<RecordedTrace> traces;
  std::vector<Knot> knots;
  std::vector<Loop> loops;
};

// The trace of this robot during which the sweep was, or the last that began before it; -1: none.
std::int32_t TraceAt(const Parts& parts, std::size_t robot, std::size_t sweep);

// Where a trace's frame lies in the assembled world: its way's knots are off their dead reckoning by so much
// on average.
Point MovedBy(const RecordedTrace& trace, const std::vector<Knot>& knots);

}  // namespace cairn::local_map
