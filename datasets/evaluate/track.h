// Time-stamped poses, and what lies between them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "schema/blob.h"
#include "schema/geometry.h"

namespace cairn::datasets {

inline constexpr double kMaxGapS = 1;  // a longer gap between two true poses is not bridged

struct Track {
  std::vector<double> time_s;  // never runs backwards
  std::vector<Pose> poses;
};

// Columns `<prefix>time_s`, `<prefix><field>x_m`, `…y_m`, `…heading_rad`; an empty track where there is no
// time_s.
Track ReadTrack(const Blob& blob, const std::string& prefix, const std::string& field = "");

// The pose at `time_s`: position interpolated linearly, heading along the shorter arc. Nothing before the
// track's start, after its end, and inside a gap of more than `max_gap_s`.
std::optional<Pose> PoseAt(const Track& track, double time_s, double max_gap_s = kMaxGapS);

}  // namespace cairn::datasets
