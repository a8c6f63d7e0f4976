// The result: the map, how sure it is, and what explains each reading.
#pragma once

#include "pipelines/common/range_scans.h"
#include "pipelines/forward_map/options.h"
#include "pipelines/forward_map/plan.h"
#include "pipelines/forward_map/state.h"
#include "pipelines/forward_map/tiles.h"
#include "pipelines/pipeline.h"

namespace cairn::forward_map {

// Values of map/grid/dynamic.
inline constexpr std::uint8_t kStays = 0;
inline constexpr std::uint8_t kPassed = 1;       // free, but readings ended there that nothing else explains
inline constexpr std::uint8_t kCameAndWent = 2;  // occupied, but seen through before or after

// [Thr01] section 3.4's 'translation' of the difference into P(occupied): logistic(difference + prior logit),
// the exact conditional of that cell given all others and the readings.
double ProbabilityOf(double difference_nats, double prior);

// kind grid_map, from the partials of phase kCertainty.
Blob ResultOf(const Options& options, const PosedScans& scans, const Blob& log, const MapState& map,
              const std::vector<Tile>& tiles, const Blob& history, const Schedule& schedule,
              Partials& partials);

}  // namespace cairn::forward_map
