// Whether two lasers of a robot see the same walls in the same places. Where one's mount is wrong each wall
// stands twice, and the path may be right all the same.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pipelines/local_map/path/runs.h"
#include "pipelines/local_map/path/scale_watch.h"

namespace cairn::local_map {

// Of the hits of `second` at places at which `first` looked during the same five metres of the path, the
// share that lies where `first` met something, and not in what it saw free: as the mounts are, and as if the
// second sat elsewhere on the robot, by the motion that explains most.
struct LaserAgreement {
  std::int32_t first = 0, second = 0;  // rings; the first is the one that looks further around
  std::int64_t looked = 0, moved_looked = 0;
  double share = 0, moved_share = 0;  // 0 where it looked nowhere
  double moved_m = 0, moved_rad = 0;
};

// `path`: of the robot, one pose a scan. `read`: a scan's rings, valid until the next call; `tick` is called
// now and then. One for each pair of lasers that looked at the same places; none where there is one laser.
std::vector<LaserAgreement> CompareLasers(const std::vector<ScaleWatch::Ring>& rings,
                                          const std::vector<Scan>& path,
                                          const std::function<std::span<const RingScan>(std::size_t)>& read,
                                          const std::function<void()>& tick);

}  // namespace cairn::local_map
