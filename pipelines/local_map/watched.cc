#include "pipelines/local_map/watched.h"

#include <algorithm>

#include "pipelines/common/handed_over.h"

namespace cairn::local_map {

std::size_t RobotOf(const Blob& partial, std::size_t robots) {
  const auto robot = partial.Scalar<std::int64_t>("robot");
  RequireWithin("robot", robot, 0, static_cast<std::int64_t>(robots) - 1);
  return static_cast<std::size_t>(robot);
}

Watched WatchedBy(Partials& partials, std::size_t robots) {
  Watched watched{std::vector<std::vector<float>>(robots), std::vector<std::vector<Approach>>(robots),
                  std::vector<std::vector<Contradiction>>(robots), std::vector<std::vector<WayFit>>(robots)};
  for (std::size_t k = 0; k < partials.size(); ++k) {
    const BlobPtr partial = partials.Get(k);
    const std::size_t r = RobotOf(*partial, robots);
    const auto edges = partial->Get<float>("edges_m");
    watched.edges_m[r].insert(watched.edges_m[r].end(), edges.begin(), edges.end());
    const auto first = partial->Scalar<std::int64_t>("first"), own = partial->Scalar<std::int64_t>("own");
    for (Approach approach : RowsIn<Approach>(*partial, "approaches/")) {
      approach.scan += own;
      watched.approaches[r].push_back(approach);
    }
    for (WayFit fit : RowsIn<WayFit>(*partial, "ways/")) {
      fit.scan += own;
      watched.ways[r].push_back(fit);
    }
    for (Contradiction contradiction : RowsIn<Contradiction>(*partial, "motion/")) {
      contradiction.from += first;
      contradiction.to += first;
      watched.motion[r].push_back(contradiction);
    }
  }
  return watched;
}

std::vector<OrientationSight> SightsOf(const std::vector<Scan>& scans, const std::vector<float>& edges) {
  std::vector<OrientationSight> sights(scans.size());
  RequireSize("edges_m", edges.size(), scans.size() * kBins);
  for (std::size_t s = 0; s < scans.size(); ++s) {
    sights[s].path_m = scans[s].path_m;
    sights[s].heading_rad = scans[s].pose.heading_rad;
    std::copy_n(edges.begin() + static_cast<std::ptrdiff_t>(s * kBins), kBins, sights[s].edges_m.begin());
    sights[s].begins = s > 0 && scans[s].jumped;
  }
  return sights;
}

OrientationTrack TrackWalls(std::vector<OrientationSight> sights, const std::vector<double>& missed_rad,
                            const OrientationOptions& options) {
  for (std::size_t s = 0; s < missed_rad.size(); ++s) {
    sights[s].heading_rad += missed_rad[s];
    sights[s].edges_m = Turned(sights[s].edges_m, missed_rad[s]);
  }
  OrientationTrack track = TrackOrientation(sights, options);
  for (std::size_t s = 0; s < missed_rad.size(); ++s) track.at[s].angle_rad -= missed_rad[s];
  return track;
}

}  // namespace cairn::local_map
