#include "pipelines/local_map/grids/wall_orientation.h"

namespace cairn::local_map {

void WallOrientation::Add(std::span<const Edge> edges, std::int32_t ticks) {
  histogram_.Scale(decay_.After(ticks));
  const float weight = decay_.Weight(ticks);
  for (const Edge& edge : edges) {
    const double sd_deg = DegOf(edge.sd_rad);
    // [DM98] section 3.2: 8 sectors of directions modulo pi / 2
    histogram_.Add(edge.angle_rad, kPeriodRad, weight / static_cast<float>(sd_deg * sd_deg));
  }
}

std::optional<AnglePeak> WallOrientation::Dominant() const {
  const AnglePeak peak = PeakOf(histogram_, kPeriodRad);
  if (peak.weight < rule_.weight || peak.strength < rule_.strength) return std::nullopt;
  return peak;
}

}  // namespace cairn::local_map
