#include "pipelines/local_map/path/way_watch.h"

#include <algorithm>
#include <array>
#include <utility>

#include "pipelines/local_map/path/motion_watch.h"

namespace cairn::local_map {
namespace {

// By odometry: over a short way a room stays in view, over a longer one a small error shows.
constexpr std::array kWays_m{0.8, 1.6, 4.0};
constexpr double kMostTurnOnWay_rad = 1.0, kLeastLooked = 20;

}  // namespace

std::size_t NearestWayScale(double scale) {
  const double at = std::round(std::log(scale) / 0.05) + 28;
  return static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(kWayScales - 1)));
}

WayWatch::WayWatch(const std::vector<ScaleWatch::Ring>& rings) : last_(kWays_m.size()) {
  const auto laser = LaserOfMostBeams(rings);
  if (!laser) return;
  ring_ = *laser;
  fan_.assign(1, LaserFan(rings[ring_].beams, rings[ring_].max_range_m));
}

void WayWatch::Update(std::int64_t scan, const Pose& pose, std::span<const RingScan> read) {
  if (fan_.empty() || read[ring_].range_m.empty()) return;
  if (at_) path_m_ += std::hypot(pose.x_m - at_->x_m, pose.y_m - at_->y_m);
  at_ = pose;
  for (std::size_t w = 0; w < kWays_m.size(); ++w) {
    if (last_[w] && path_m_ - last_[w]->path_m < kWays_m[w]) continue;
    Seen now{pose, path_m_, fan_.front().View(read[ring_])};
    if (last_[w]) {
      const Seen& before = *last_[w];
      const Pose moved = Between(before.pose, pose);
      WayFit fit{scan, {}};
      double tells = 0;
      for (std::size_t k = 0; k < kWayScales; ++k) {
        const double scale = WayScale(k);
        const ScanMotion weighed =
            WeighMotion(before.view, now.view, {scale * moved.x_m, scale * moved.y_m, moved.heading_rad});
        fit.share[k] = weighed.share;
        tells = std::max(tells, weighed.looked);
      }
      if (std::abs(moved.heading_rad) <= kMostTurnOnWay_rad && tells >= kLeastLooked) found_.push_back(fit);
    }
    last_[w] = std::move(now);
  }
}

}  // namespace cairn::local_map
