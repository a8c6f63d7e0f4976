#include "pipelines/local_map/path/scale_watch.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "schema/kinds/log.h"
#include "schema/square.h"

namespace cairn::local_map {
namespace {

constexpr double kRightAngle_rad = std::numbers::pi / 2;
constexpr double kRay_rad = 0.05;  // of a beam without a cone from the axis
constexpr double kMostCone_rad = 0.2;
constexpr double kSameWall_m = 0.12;  // a distance that is further off the wall so far is of another thing
constexpr double kAside_m = 0.25;     // and so is what is met this far to the side of the first scan
constexpr double kBend_rad = 0.1, kMostScale = 3.5;
constexpr double kShortest_m = 0.5, kLongest_m = 2;
constexpr std::size_t kLeastScans = 5;
// Ahead, of a laser that is read every metre: many such drives must agree (path/scale_track.h).
constexpr std::size_t kLeastScansAhead = 3;
constexpr double kLongestOfFew_m = 4;
constexpr double kLeastApproaches = 5;
constexpr double kUsualSd = 0.03;  // of a scale
constexpr double kOutlier = 0.1;   // of a scale

struct WallReading {
  double off_rad, distance_m;
};

}  // namespace

ScaleWatch::ScaleWatch(std::vector<Ring> rings, Towards towards)
    : rings_(std::move(rings)), towards_(towards), drives_(towards == Towards::kAxes ? 4 : 2) {
  for (std::size_t k = 0; k < drives_.size(); ++k)
    drives_[k].direction_rad = static_cast<double>(k) * kRightAngle_rad;
}

// Of the beam that points there best.
std::optional<double> ScaleWatch::DistanceTo(double direction_rad, const Pose& pose,
                                             std::span<const RingScan> scans) const {
  std::optional<WallReading> best;
  for (std::size_t r = 0; r < rings_.size(); ++r) {
    const Ring& ring = rings_[r];
    if (towards_ == Towards::kAhead && ring.opening_rad > 0) continue;
    const double most = ring.opening_rad > 0 ? std::min(ring.opening_rad / 2, kMostCone_rad) : kRay_rad;
    for (std::size_t b = 0; b < scans[r].range_m.size(); ++b) {
      const double range = scans[r].range_m[b];
      const Pose on_robot = Compose({0, 0, pose.heading_rad + scans[r].turret_rad}, ring.beams[b]);
      const double off = std::abs(WrapAngle(on_robot.heading_rad - direction_rad));
      if (off > most || (best && off >= best->off_rad) || !kinds::IsEcho(range, ring.max_range_m)) continue;
      const double c = std::cos(direction_rad), s = std::sin(direction_rad);
      const double begins = c * on_robot.x_m + s * on_robot.y_m;
      best = WallReading{off, begins + (ring.opening_rad > 0 ? range : range * std::cos(off))};
    }
  }
  if (!best) return std::nullopt;
  return best->distance_m;
}

bool ScaleWatch::GoesOn(const Drive& drive, double along_m, double aside_m, double distance_m) const {
  const bool few = towards_ == Towards::kAhead && drive.scan.size() < kLeastScans;
  const double longest_m = few ? kLongestOfFew_m : kLongest_m;
  if (std::abs(aside_m - drive.aside_m) > kAside_m || std::abs(along_m - drive.along_m.front()) > longest_m)
    return false;
  const double nearer_m = drive.distance_m.back() - distance_m, step_m = along_m - drive.along_m.back();
  if (towards_ == Towards::kAxes) return std::abs(nearer_m - step_m) <= kSameWall_m;
  const auto [least_m, most_m] = std::minmax({step_m / kMostScale, step_m * kMostScale});
  return nearer_m >= least_m - kSameWall_m / 2 && nearer_m <= most_m + kSameWall_m / 2;
}

void ScaleWatch::Update(std::int64_t scan, const Pose& pose, std::span<const RingScan> scans) {
  for (std::size_t k = 0; k < drives_.size(); ++k) {
    Drive& drive = drives_[k];
    const double faces_rad = pose.heading_rad + (k == 0 ? 0 : std::numbers::pi);
    if (towards_ == Towards::kAhead && std::abs(faces_rad - drive.direction_rad) > kBend_rad) Close(&drive);
    for (bool added = false; !added;) {
      if (towards_ == Towards::kAhead && drive.along_m.empty()) drive.direction_rad = faces_rad;
      const std::optional<double> distance = DistanceTo(drive.direction_rad, pose, scans);
      if (!distance) break;
      const double c = std::cos(drive.direction_rad), s = std::sin(drive.direction_rad);
      const double along = c * pose.x_m + s * pose.y_m, aside = -s * pose.x_m + c * pose.y_m;
      if (drive.along_m.empty()) drive.aside_m = aside;
      added = drive.along_m.empty() || GoesOn(drive, along, aside, *distance);
      if (!added) {
        Close(&drive);  // and it begins another one
        continue;
      }
      drive.along_m.push_back(along);
      drive.distance_m.push_back(*distance);
      drive.scan.push_back(scan);
    }
  }
}

void ScaleWatch::Finish() {
  for (Drive& drive : drives_) Close(&drive);
}

void ScaleWatch::Close(Drive* drive) {
  const std::size_t n = drive->along_m.size();
  if (n >= (towards_ == Towards::kAhead ? kLeastScansAhead : kLeastScans)) {
    double along = 0, distance = 0;
    for (std::size_t k = 0; k < n; ++k) {
      along += drive->along_m[k] / static_cast<double>(n);
      distance += drive->distance_m[k] / static_cast<double>(n);
    }
    const auto [least, most] = std::ranges::minmax(drive->along_m);
    Approach approach{.scan = drive->scan[n / 2]};
    double distance2 = 0;
    for (std::size_t k = 0; k < n; ++k) {
      approach.along2_m2 += (drive->along_m[k] - along) * (drive->along_m[k] - along);
      approach.along_distance_m2 += (drive->along_m[k] - along) * (drive->distance_m[k] - distance);
      distance2 += Square(drive->distance_m[k] - distance);
    }
    const double off2 = std::max(0.0, distance2 - Square(approach.along_distance_m2) / approach.along2_m2);
    approach.sd = std::sqrt(off2 / static_cast<double>(n) / approach.along2_m2);
    if (most - least >= kShortest_m) approaches_.push_back(approach);
  }
  drive->along_m.clear();
  drive->distance_m.clear();
  drive->scan.clear();
}

double FitScale(const std::vector<Approach>& approaches) {
  double scale = 1;
  for (int repeat = 0; repeat < 5; ++repeat) {
    double along2 = 0, distance = 0, squares = 0, count = 0;
    for (const Approach& a : approaches) {
      const double off = a.Scale() - scale;
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
