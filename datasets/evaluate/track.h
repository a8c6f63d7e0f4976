// Time-stamped poses, and what lies between them.
#pragma once

#include <optional>
#include <vector>

#include "schema/geometry.h"
#include "schema/kinds/poses.h"

namespace cairn::datasets {

inline constexpr double kMaxGapS = 1;  // a longer gap between two true poses is not bridged

struct Track {
  std::vector<double> time_s;  // never runs backwards
  std::vector<Pose> poses;
};

// An empty track where there is no time_s.
Track TrackOf(const kinds::PoseTable& poses);
inline Track ReadTrack(const Blob& blob, const std::string& prefix) {
  return TrackOf(FieldsIn<kinds::PoseTable>(prefix, blob));
}

// The pose at `time_s`: position interpolated linearly, heading along the shorter arc. Nothing before the
// track's start, after its end, and inside a gap of more than `max_gap_s`.
std::optional<Pose> PoseAt(const Track& track, double time_s, double max_gap_s = kMaxGapS);

}  // namespace cairn::datasets
