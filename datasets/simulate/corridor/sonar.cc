#include "datasets/simulate/corridor/sonar.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "datasets/simulate/sonar.h"

namespace cairn::datasets::corridor {

std::vector<float> SonarRanges(const Scene& scene, const Snapshot& snapshot, Rng& rng) {
  constexpr int kRaysOfACone = 5;
  const std::vector<Pillar> pillars = scene.PillarsNear(snapshot.pose.x_m, snapshot.time_s);
  const Vec3 from{snapshot.pose.x_m, snapshot.pose.y_m, kSonarHeightM};
  std::vector<float> ranges;
  for (int beam = 0; beam < kSonars; ++beam) {
    const double heading = snapshot.pose.heading_rad + beam * 2 * std::numbers::pi / kSonars;
    double nearest = kSonarMaxRangeM;
    for (int ray = 0; ray < kRaysOfACone; ++ray) {
      const double angle = heading + kSonarOpeningRad * (ray / (kRaysOfACone - 1.0) - 0.5);
      const Hit hit = scene.Cast(from, {std::cos(angle), std::sin(angle), 0}, pillars);
      nearest = std::min(nearest, hit.distance - kSonarRingM);
    }
    const double measured = nearest + kSonarSdM * rng.Normal();
    const bool lost = rng.Uniform() < kSonarDropouts || nearest >= kSonarMaxRangeM;
    ranges.push_back(static_cast<float>(lost ? kSonarMaxRangeM : std::clamp(measured, 0.0, kSonarMaxRangeM)));
  }
  return ranges;
}

}  // namespace cairn::datasets::corridor
