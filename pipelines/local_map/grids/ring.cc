#include "pipelines/local_map/grids/ring.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "schema/error.h"
#include "schema/kinds/log.h"

namespace cairn::local_map {
namespace {

// A ring is closed where the gap between its ends is no wider than twice the widest within it.
bool IsClosed(const std::vector<Pose>& beams) {
  if (beams.size() < 3) return false;
  double widest = 0;
  for (std::size_t b = 1; b < beams.size(); ++b)
    widest = std::max(widest, std::abs(WrapAngle(beams[b].heading_rad - beams[b - 1].heading_rad)));
  return std::abs(WrapAngle(beams.front().heading_rad - beams.back().heading_rad)) <= 2 * widest;
}

}  // namespace

SensorRing::SensorRing(const std::vector<Pose>& beams, double opening_rad, double max_range_m, int sectors)
    : half_opening_(opening_rad / 2), max_range_m_(max_range_m), closed_(IsClosed(beams)) {
  CAIRN_DEMAND(sectors >= 0, "a ring has no less than no sectors");
  for (std::size_t b = 0; b < beams.size(); ++b) {
    const Pose &beam = beams[b], &next = beams[(b + 1) % beams.size()];
    const double c = std::cos(beam.heading_rad), s = std::sin(beam.heading_rad);
    beams_.push_back({beam.x_m, beam.y_m, c, s, beam.x_m * c + beam.y_m * s,
                      WrapAngle(next.heading_rad - beam.heading_rad)});
  }
  const std::size_t groups =
      sectors == 0 ? beams.size() : std::min(beams.size(), static_cast<std::size_t>(sectors));
  for (std::size_t g = 0; g <= groups; ++g)
    first_beam_.push_back(groups == 0 ? 0 : g * beams.size() / groups);
}

// NaN: no hit.
double SensorRing::RangeM(const RingScan& scan, std::size_t beam) const {
  const double range_m = scan.range_m[beam];
  return range_m > 0 && kinds::IsEcho(range_m, max_range_m_) ? range_m
                                                             : std::numeric_limits<double>::quiet_NaN();
}

std::size_t SensorRing::Nearest(const RingScan& scan, std::size_t sector) const {
  std::size_t nearest = first_beam_[sector];
  double range_m = RangeM(scan, nearest);
  for (std::size_t b = nearest + 1; b < first_beam_[sector + 1]; ++b) {
    const double other_m = RangeM(scan, b);
    if (!(other_m < range_m || std::isnan(range_m))) continue;
    nearest = b;
    range_m = other_m;
  }
  return nearest;
}

// Of all that lies in its cone a sonar hears the nearest point: of a wall that it meets at a slant the one at
// the cone's edge. The tangent of the angle, from the beam's axis, at which the echo arose: towards the
// neighbour that is nearer, as far as neighbours seem to meet the same surface.
double SensorRing::Aside(const RingScan& scan, std::size_t beam) const {
  if (half_opening_ == 0) return 0;
  constexpr double kSteepest = 1.7;  // a surface at 60 degrees
  const std::size_t n = beams_.size();
  const double here_m = beams_[beam].ahead_m + RangeM(scan, beam);
  double slope = 0;
  int neighbours = 0;
  const auto add = [&](std::size_t other, double apart_rad) {
    const double other_m = beams_[other].ahead_m + RangeM(scan, other);
    const double grows = (other_m - here_m) / (here_m * apart_rad);
    if (!(std::abs(grows) <= kSteepest)) return;  // another surface, or no range
    slope += grows;
    ++neighbours;
  };
  if (beam + 1 < n || closed_) add((beam + 1) % n, beams_[beam].next_rad);
  if (beam > 0 || closed_) add((beam + n - 1) % n, -beams_[(beam + n - 1) % n].next_rad);
  if (neighbours == 0) return 0;
  return std::clamp(-slope / neighbours, -half_opening_, half_opening_);
}

std::size_t SensorRing::Hits(const Pose& robot, const RingScan& scan, std::span<Point> hits) const {
  if (scan.range_m.empty()) return 0;
  CAIRN_DEMAND(scan.range_m.size() == beams_.size(), "a range for each beam");
  // [DM98] section 2: the turret turns by itself.
  const double heading = robot.heading_rad + scan.turret_rad;
  const double c = std::cos(heading), s = std::sin(heading);
  std::size_t count = 0;
  for (std::size_t g = 0; g < sectors(); ++g) {
    const std::size_t nearest = Nearest(scan, g);
    const double range_m = RangeM(scan, nearest);
    if (std::isnan(range_m)) continue;
    const Beam& beam = beams_[nearest];
    const double aside = Aside(scan, nearest);
    const double along = range_m / std::sqrt(1 + aside * aside);
    const double x = beam.x_m + along * (beam.cos - aside * beam.sin);
    const double y = beam.y_m + along * (beam.sin + aside * beam.cos);
    hits[count++] = {robot.x_m + c * x - s * y, robot.y_m + s * x + c * y};
  }
  return count;
}

}  // namespace cairn::local_map
