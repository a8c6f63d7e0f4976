// The arrays of a local_map (schema/FORMAT.md).
#pragma once

#include <string>
#include <vector>

#include "pipelines/local_map/path/orientation_track.h"
#include "pipelines/local_map/path/parts.h"
#include "pipelines/local_map/path/pass_watch.h"
#include "schema/blob.h"

namespace cairn::local_map {

// Of each scan angle_rad, strength, other_area, locked; the angle on top of that of `before`, the track
// through whose path this one was made; may be null.
Blob WallsBlob(const OrientationTrack& track, const Blob* before);

// poses/ and walls/ of a robot.
void PutPath(const std::string& prefix, const std::vector<Scan>& scans, const Blob& walls, Blob* result);

// FORMAT.md's passes/. Throws InputError where they are of other scans.
void PutPasses(const std::string& prefix, const std::vector<Passing>& passes, const std::vector<Scan>& scans,
               Blob* result);

void PutTraces(const Parts& parts, Blob* result);
void PutConnections(const Parts& parts, Blob* result);

}  // namespace cairn::local_map
