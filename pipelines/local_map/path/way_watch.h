// How well a laser's whole scans fit where the robot went so many times as far as odometry says: what comes
// nearer ahead may be a person, what stands beside the way does not move.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "pipelines/local_map/path/scale_watch.h"
#include "pipelines/local_map/path/scan_motion.h"

namespace cairn::local_map {

// Scales of ways that are looked at, evenly by their logarithms, from 0.25 to 4; the one in the middle is 1.
inline constexpr std::size_t kWayScales = 57;
inline double WayScale(std::size_t k) { return std::exp(0.05 * (static_cast<double>(k) - 28)); }
std::size_t NearestWayScale(double scale);

// Of two scans: the share of the second's hits that lie where the first saw something, by the scale of the
// way between them.
struct WayFit {
  std::int64_t scan = 0;  // the second
  double share[kWayScales] = {};
  static void Fields(const auto& field) {
    field("scan", &WayFit::scan);
    field("share", &WayFit::share);
  }
};

class WayWatch {
 public:
  // Looks at the laser that has the most beams; at nothing where there is none.
  explicit WayWatch(const std::vector<ScaleWatch::Ring>& rings);
  // Scan number `scan` at a pose of dead reckoning.
  void Update(std::int64_t scan, const Pose& pose, std::span<const RingScan> read);
  const std::vector<WayFit>& found() const { return found_; }

 private:
  struct Seen {
    Pose pose;
    double path_m = 0;
    LaserView view;
  };
  std::size_t ring_ = 0;
  std::vector<LaserFan> fan_;              // none or one
  std::vector<std::optional<Seen>> last_;  // of each length of ways
  std::optional<Pose> at_;                 // the scan before
  double path_m_ = 0;
  std::vector<WayFit> found_;
};

}  // namespace cairn::local_map
