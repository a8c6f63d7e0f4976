#include "pipelines/forward_map/tile_task.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pipelines/forward_map/testing_room.h"
#include "pipelines/forward_map/weigh.h"
#include "pipelines/in_process.h"

namespace cairn::forward_map {
namespace {

double Weighed(const MapState& map, const std::vector<RangeScans>& sensors) {
  NoProgress progress;
  double sum = 0;
  for (std::size_t k = 0; k < sensors.size(); ++k) {
    sum += Weigh(sensors[k], 0, sensors[k].scans(), map.box, map.occupied, map.models[k], true, progress)
               .log_likelihood;
  }
  return sum;
}

// The search's bookkeeping against the model written out, over the same scans; of the whole map and of tiles
// whose surroundings hold obstacles.
TEST(SearchTile, GainsWhatWeighingFinds) {
  for (const double opening_rad : {0.0, 0.3}) {
    const Room room{.opening_rad = opening_rad};
    NoProgress progress;
    MapState map = room.EmptyMap(0.1);
    const std::vector<RangeScans> sensors = room.Sensors();
    const auto columns = static_cast<std::int32_t>(map.box.columns),
               rows = static_cast<std::int32_t>(map.box.rows);
    for (const Tile& tile : {Tile{0, 0, columns, rows}, Tile{5, 3, columns / 2, rows / 2},
                             Tile{columns / 2, 0, columns - columns / 2, rows}}) {
      const double before = Weighed(map, sensors);
      const Proposal proposal = SearchTile({}, map, tile, sensors, Elsewhere::kAsInTheMap, progress);
      Apply({proposal}, 1, &map.occupied);
      EXPECT_NEAR(Weighed(map, sensors) - before, proposal.gain, 1e-9 * std::abs(before));
      map.models[0].sigma_m *= 0.8;
      map.models[0].p_hit *= 0.8;
    }
  }
}

}  // namespace
}  // namespace cairn::forward_map
