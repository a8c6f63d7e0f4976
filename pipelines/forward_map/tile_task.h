// The tasks that are given a tile of the map and all readings: its search, and how sure its cells are.
#pragma once

#include <vector>

#include "pipelines/common/range_scans.h"
#include "pipelines/forward_map/flip_gains.h"
#include "pipelines/forward_map/options.h"
#include "pipelines/forward_map/state.h"
#include "pipelines/forward_map/tiles.h"
#include "pipelines/pipeline.h"
#include "schema/kinds/fields.h"

namespace cairn::forward_map {

MapPrior PriorOf(const Options& options);

// A tile's cells, the readings whose beams meet them up to where it matters, and the time of each. Obstacles
// outside of the tile stay as they are in the map.
struct TileGains {
  FlipGains gains;
  Patch patch;
  std::vector<double> time_s;
};
enum class Elsewhere {
  kAsInTheMap,
  // A reading that ends in other tiles is taken to be explained there, whatever the map says: from an empty
  // map all tiles set out together, and beams that pass through one must not look as if nothing stopped them.
  kExplained
};
TileGains GainsOfTile(const MapState& map, const std::vector<SensorModel>& models, const Tile& tile,
                      const std::vector<RangeScans>& sensors, bool no_echo, Elsewhere elsewhere,
                      Progress& progress);

Proposal SearchTile(const Options& options, const MapState& map, const Tile& tile,
                    const std::vector<RangeScans>& sensors, Elsewhere elsewhere, Progress& progress);

// [Thr01] section 3.4, of the tile's cells: the difference that decides, log p(Z | m: occupied) -
// log p(Z | m: free), NaN where no reading that matters met the cell; and whether an occupied one came and
// went (dynamic.h). And how much of the difference those readings contribute that the map is checked with.
struct Certainty {
  std::vector<double> difference_nats, of_checked_nats;
  std::vector<std::uint8_t> came_and_went;

  static void Fields(const auto& field) {
    field("difference_nats", &Certainty::difference_nats);
    field("of_checked_nats", &Certainty::of_checked_nats);
    field("came_and_went", &Certainty::came_and_went);
  }
};
Certainty CertaintyOfTile(const Options& options, const MapState& map, const Tile& tile,
                          const std::vector<RangeScans>& sensors, Progress& progress);

}  // namespace cairn::forward_map
