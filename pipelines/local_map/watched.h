// What the tasks that watch walls saw, of each robot.
#pragma once

#include <cstddef>
#include <vector>

#include "pipelines/local_map/path/motion_watch.h"
#include "pipelines/local_map/path/orientation_track.h"
#include "pipelines/local_map/path/scale_watch.h"
#include "pipelines/local_map/path/way_watch.h"
#include "pipelines/pipeline.h"

namespace cairn::local_map {

struct Watched {
  std::vector<std::vector<float>> edges_m;
  std::vector<std::vector<Approach>> approaches;
  std::vector<std::vector<Contradiction>> motion;
  std::vector<std::vector<WayFit>> ways;
};

// Which robot a partial is of. Throws where there is none such.
std::size_t RobotOf(const Blob& partial, std::size_t robots);

Watched WatchedBy(Partials& partials, std::size_t robots);

// `edges`: kBins of each scan.
std::vector<OrientationSight> SightsOf(const std::vector<Scan>& scans, const std::vector<float>& edges);

// Odometry's headings made good by what the scans show of turns that it missed; the track is that of the
// walls in the frame of dead reckoning all the same.
OrientationTrack TrackWalls(std::vector<OrientationSight> sights, const std::vector<double>& missed_rad,
                            const OrientationOptions& options);

}  // namespace cairn::local_map
