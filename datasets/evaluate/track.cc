#include "datasets/evaluate/track.h"

#include <algorithm>
#include <cmath>

namespace cairn::datasets {

Track TrackOf(const kinds::PoseTable& poses) {
  if (!poses.time_s) return {};
  return {poses.time_s.vector(), poses.poses()};
}

std::optional<Pose> PoseAt(const Track& track, double time_s, double max_gap_s) {
  const auto after = std::lower_bound(track.time_s.begin(), track.time_s.end(), time_s);
  if (after == track.time_s.end()) return std::nullopt;
  const auto i = static_cast<std::size_t>(after - track.time_s.begin());
  if (*after == time_s) return track.poses[i];
  if (i == 0) return std::nullopt;
  const double gap_s = track.time_s[i] - track.time_s[i - 1];
  if (gap_s > max_gap_s) return std::nullopt;
  const double share = (time_s - track.time_s[i - 1]) / gap_s;
  return Interpolate(track.poses[i - 1], track.poses[i], share);
}

}  // namespace cairn::datasets
