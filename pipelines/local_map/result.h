// The arrays of a local_map (schema/FORMAT.md).
#pragma once

#include <string>
#include <vector>

#include "pipelines/local_map/orientation_track.h"
#include "pipelines/local_map/pairs.h"
#include "pipelines/local_map/runs.h"
#include "schema/blob.h"

namespace cairn::local_map {

// Of each sweep angle_rad, strength, other_area, locked; the angle on top of that of `before`, the track
// through whose path this one was made; may be null.
Blob WallsBlob(const OrientationTrack& track, const Blob* before);

// A loop: a knot that was matched with a trace.
struct Loop {
  std::size_t knot = 0;   // of whose surroundings
  std::size_t trace = 0;  // on which
  Position at;            // where it was found there; NaN: not told
  double quality = 0;
  bool used = false;
};

// What the result is made of. `sweeps` are those of the assembled path.
struct Parts {
  std::vector<std::vector<Sweep>> sweeps;  // [robots]
  std::vector<RecordedTrace> traces;
  std::vector<Knot> knots;
  std::vector<Loop> loops;
};

void PutPoses(const std::string& prefix, const std::vector<Sweep>& sweeps, Blob* result);
void PutWalls(const std::string& prefix, const std::vector<Sweep>& sweeps, const Blob& walls, Blob* result);
void PutTraces(const Parts& parts, Blob* result);
void PutConnections(const Parts& parts, Blob* result);

// The trace of this robot during which the sweep was, or the last that began before it; -1: none.
std::int32_t TraceAt(const Parts& parts, std::size_t robot, std::size_t sweep);

// Where a trace's frame lies in the assembled world: its way's knots are off their dead reckoning by so much
// on average.
Point MovedBy(const RecordedTrace& trace, const std::vector<Knot>& knots);

}  // namespace cairn::local_map
