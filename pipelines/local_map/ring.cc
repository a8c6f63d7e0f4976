#include "pipelines/local_map/ring.h"

#include <algorithm>
#include <cmath>

#include "schema/error.h"

namespace cairn::local_map {
namespace {

// A ring is closed where the gap between its ends is no wider than twice the widest within it.
bool IsClosed(const std::vector<Pose>& beams) {
  if (beams.size() < 3) return false;
  double widest = 0;
  for (std::size_t b = 1; b < beams.size(); ++b)
    widest = std::max(widest, std::abs(Wrapped(beams[b].heading_rad - beams[b - 1].heading_rad)));
  return std::abs(Wrapped(beams.front().heading_rad - beams.back().heading_rad)) <= 2 * widest;
}

}  // namespace

SensorRing::SensorRing(const std::vector<Pose>& beams, double max_range_m, int sectors)
    : max_range_m_(max_range_m), closed_(IsClosed(beams)) {
  CAIRN_DEMAND(sectors >= 0, "a ring has no less than no sectors");
  for (const Pose& beam : beams)
    beams_.push_back({beam.x_m, beam.y_m, std::cos(beam.heading_rad), std::sin(beam.heading_rad)});
  const std::size_t groups =
      sectors == 0 ? beams.size() : std::min(beams.size(), static_cast<std::size_t>(sectors));
  for (std::size_t g = 0; g <= groups; ++g)
    first_beam_.push_back(groups == 0 ? 0 : g * beams.size() / groups);
}

std::size_t SensorRing::Hits(const Pose& robot, const RingSweep& sweep, std::span<Point> hits) const {
  if (sweep.range_m.empty()) return 0;
  CAIRN_DEMAND(sweep.range_m.size() == beams_.size(), "a range for each beam");
  const double heading = robot.heading_rad + sweep.turret_rad;
  const double c = std::cos(heading), s = std::sin(heading);
  std::size_t count = 0;
  for (std::size_t g = 0; g < sectors(); ++g) {
    std::size_t nearest = first_beam_[g];
    double range_m = sweep.range_m[nearest];
    for (std::size_t b = nearest + 1; b < first_beam_[g + 1]; ++b) {
      // A NaN is less than nothing, and nothing is less than a NaN.
      if (sweep.range_m[b] < range_m || std::isnan(range_m)) range_m = sweep.range_m[nearest = b];
    }
    if (!(range_m > 0 && range_m <= max_range_m_)) continue;
    const Beam& beam = beams_[nearest];
    const double x = beam.x_m + range_m * beam.cos, y = beam.y_m + range_m * beam.sin;
    hits[count++] = {robot.x_m + c * x - s * y, robot.y_m + s * x + c * y};
  }
  return count;
}

}  // namespace cairn::local_map
