#include "pipelines/local_map/path/scale_watch.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace cairn::local_map {
namespace {

constexpr double kRightAngle_rad = std::numbers::pi / 2;
constexpr double kRay_rad = 0.05;  // of a beam without a cone from the axis
constexpr double kMostCone_rad = 0.2;
constexpr double kSameWall_m = 0.12;  // a distance that is further off the wall so far is of another thing
constexpr double kAside_m = 0.25;     // and so is what is met this far to the side of the first scan
constexpr double kShortest_m = 0.5, kLongest_m = 2;
constexpr std::size_t kLeastScans = 5;
constexpr double kLeastApproaches = 5;
constexpr double kUsualSd = 0.03;  // of a scale
constexpr double kOutlier = 0.1;   // of a scale

struct WallReading {
  double off_rad, distance_m;
};

// Along `quarter`, of the beam that points there best.
std::optional<double> DistanceAlong(int quarter, const Pose& pose, const std::vector<ScaleWatch::Ring>& rings,
                                    std::span<const RingScan> scans) {
  std::optional<WallReading> best;
  for (std::size_t r = 0; r < rings.size(); ++r) {
    const ScaleWatch::Ring& ring = rings[r];
    const double most = ring.opening_rad > 0 ? std::min(ring.opening_rad / 2, kMostCone_rad) : kRay_rad;
    for (std::size_t b = 0; b < scans[r].range_m.size(); ++b) {
      const double range = scans[r].range_m[b];
      const Pose on_robot = Compose({0, 0, pose.heading_rad + scans[r].turret_rad}, ring.beams[b]);
      const double off = std::abs(WrapAngle(on_robot.heading_rad - quarter * kRightAngle_rad));
      if (off > most || (best && off >= best->off_rad) || !(range < ring.max_range_m)) continue;
      const double c = std::cos(quarter * kRightAngle_rad), s = std::sin(quarter * kRightAngle_rad);
      const double begins = c * on_robot.x_m + s * on_robot.y_m;
      best = WallReading{off, begins + (ring.opening_rad > 0 ? range : range * std::cos(off))};
    }
  }
  if (!best) return std::nullopt;
  return best->distance_m;
}

}  // namespace

void ScaleWatch::Update(const Pose& pose, std::span<const RingScan> scans) {
  for (int quarter = 0; quarter < 4; ++quarter) {
    const std::optional<double> distance = DistanceAlong(quarter, pose, rings_, scans);
    if (!distance) continue;
    const double c = std::cos(quarter * kRightAngle_rad), s = std::sin(quarter * kRightAngle_rad);
    const double along = c * pose.x_m + s * pose.y_m, aside = -s * pose.x_m + c * pose.y_m;
    Drive& drive = drives_[static_cast<std::size_t>(quarter)];
    if (!drive.along_m.empty()) {
      const double wall = drive.along_m.back() + drive.distance_m.back();
      const bool same = std::abs(along + *distance - wall) <= kSameWall_m;
      const bool straight = std::abs(aside - drive.aside_m) <= kAside_m;
      if (!same || !straight || std::abs(along - drive.along_m.front()) > kLongest_m) Close(&drive);
    }
    if (drive.along_m.empty()) drive.aside_m = aside;
    drive.along_m.push_back(along);
    drive.distance_m.push_back(*distance);
  }
}

void ScaleWatch::Finish() {
  for (Drive& drive : drives_) Close(&drive);
}

void ScaleWatch::Close(Drive* drive) {
  const std::size_t n = drive->along_m.size();
  if (n >= kLeastScans) {
    double along = 0, distance = 0;
    for (std::size_t k = 0; k < n; ++k) {
      along += drive->along_m[k] / static_cast<double>(n);
      distance += drive->distance_m[k] / static_cast<double>(n);
    }
    const auto [least, most] = std::ranges::minmax(drive->along_m);
    Approach approach;
    for (std::size_t k = 0; k < n; ++k) {
      approach.along2_m2 += (drive->along_m[k] - along) * (drive->along_m[k] - along);
      approach.along_distance_m2 += (drive->along_m[k] - along) * (drive->distance_m[k] - distance);
    }
    if (most - least >= kShortest_m) approaches_.push_back(approach);
  }
  drive->along_m.clear();
  drive->distance_m.clear();
}

double FitScale(const std::vector<Approach>& approaches) {
  double scale = 1;
  for (int repeat = 0; repeat < 5; ++repeat) {
    double along2 = 0, distance = 0, squares = 0, count = 0;
    for (const Approach& a : approaches) {
      const double off = -a.along_distance_m2 / a.along2_m2 - scale;
      if (std::abs(off) > kOutlier) continue;
      along2 += a.along2_m2;
      distance -= a.along_distance_m2;
      squares += a.along2_m2 * a.along2_m2 * off * off;
      ++count;
    }
    if (count < kLeastApproaches) return 1;
    const double variance = squares / (along2 * along2), prior = kUsualSd * kUsualSd;
    scale = (distance / along2 * prior + variance) / (prior + variance);
  }
  return scale;
}

}  // namespace cairn::local_map
