// How long odometry's metre is along a run, by what a laser shows ahead of and behind the robot: far from one
// where somebody took it in another unit, or one that walks, as visual odometry's does.
#pragma once

#include <vector>

#include "pipelines/local_map/path/runs.h"
#include "pipelines/local_map/path/scale_watch.h"
#include "pipelines/local_map/path/way_watch.h"

namespace cairn::local_map {

// From there on, what odometry calls a metre is so many.
struct MetreAt {
  double time_s = 0, path_m = 0;  // path_m: by odometry
  double scale = 1;
  static void Fields(const auto& field) {
    field("time_s", &MetreAt::time_s);
    field("scale", &MetreAt::scale);
  }
};

// At each approach that `ScaleWatch` saw ahead of and behind the robot, in order of time. None where
// odometry's metre is one for all that they tell: steady, and off by so little that `FitScale` finds it; and
// where ten and half of them do not agree. How
// fast it walks is the likeliest of a few; that it does so at all must be likelier by ten nats.
std::vector<MetreAt> TrackScale(std::vector<Approach> approaches, const std::vector<Scan>& scans);

// Whether whole scans bear the track out: by what stands beside the way, too, its ways are the likelier ones.
// A person who comes towards the robot is a longer metre to whatever looks ahead alone.
bool IsBorneOut(const std::vector<MetreAt>& track, const std::vector<WayFit>& ways,
                const std::vector<Scan>& scans);

// Makes all ways of the scans as long as the track says, between its places by the way from one to the next.
void Rescale(const std::vector<MetreAt>& track, std::vector<Scan>* scans);

}  // namespace cairn::local_map
