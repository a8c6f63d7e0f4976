#include "datasets/evaluate/track.h"

#include <algorithm>
#include <cmath>

namespace cairn::datasets {

Track ReadTrack(const Blob& blob, const std::string& prefix, const std::string& field) {
  Track track;
  if (!blob.Has(prefix + "time_s")) return track;
  const auto time = blob.Get<double>(prefix + "time_s");
  const auto x = blob.Get<double>(prefix + field + "x_m");
  const auto y = blob.Get<double>(prefix + field + "y_m");
  const auto heading = blob.Get<double>(prefix + field + "heading_rad");
  for (std::size_t i = 0; i < time.size(); ++i) {
    track.time_s.push_back(time[i]);
    track.poses.push_back({x[i], y[i], heading[i]});
  }
  return track;
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
