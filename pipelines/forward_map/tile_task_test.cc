#include "pipelines/forward_map/tile_task.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipelines/forward_map/testing.h"
#include "pipelines/forward_map/weigh.h"
#include "pipelines/testing/in_process.h"

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
// whose surroundings hold obstacles, while the parameters change.
TEST(SearchTile, GainsWhatWeighingFinds) {
  NoProgress progress;
  for (const double opening_rad : {0.0, 0.3}) {
    for (const double anneal : {1.0, 4.0}) {
      const Room room{.opening_rad = opening_rad};
      Options options;
      options.anneal = anneal;
      options.smoothness = 0.1;
      options.prior = 0.3;
      MapState map = EmptyMapOf(room, 0.1);
      const std::vector<RangeScans> sensors = SensorsOf(room);
      const auto columns = static_cast<std::int32_t>(map.box.columns);
      const auto rows = static_cast<std::int32_t>(map.box.rows);
      for (const Tile& tile : {Tile{0, 0, columns, rows}, Tile{5, 3, columns / 2, rows / 2},
                               Tile{columns / 2, 0, columns - columns / 2, rows}}) {
        const double before = Weighed(map, sensors) + map.LogPrior(PriorOf(options));
        const Proposal proposal = SearchTile(options, map, tile, sensors, Elsewhere::kAsInTheMap, progress);
        EXPECT_GT(proposal.gain, 0);
        Apply({proposal}, 1, &map.occupied);
        EXPECT_NEAR(Weighed(map, sensors) + map.LogPrior(PriorOf(options)) - before, proposal.gain,
                    1e-9 * std::abs(before));
        map.models[0].sigma_m *= 0.8;
        map.models[0].p_hit *= 0.8;
      }
    }
  }
}

TEST(SearchTile, ByWayOfALargerSigmaEndsNoLower) {
  NoProgress progress;
  const Room room{.opening_rad = 0.3};
  const MapState map = EmptyMapOf(room, 0.1);
  const Tile all{0, 0, static_cast<std::int32_t>(map.box.columns), static_cast<std::int32_t>(map.box.rows)};
  Options options;
  const double direct = SearchTile(options, map, all, SensorsOf(room), Elsewhere::kAsInTheMap, progress).gain;
  options.anneal = 4;
  EXPECT_GE(SearchTile(options, map, all, SensorsOf(room), Elsewhere::kAsInTheMap, progress).gain, direct);
}

// From an empty map beams that end in another tile must not look as if nothing stopped them: what one of them
// passes on the way is then no obstacle for the sake of a single stray reading.
TEST(GainsOfTile, ReadingsThatEndInOtherTilesAreExplainedThereAtFirst) {
  NoProgress progress;
  const Room room{};
  const MapState map = EmptyMapOf(room, 0.1);
  const Tile middle{static_cast<std::int32_t>(map.box.columns / 2) - 5,
                    static_cast<std::int32_t>(map.box.rows / 2) - 14, 10, 10};
  const auto sensors = SensorsOf(room);
  const TileGains alone =
      GainsOfTile(map, map.models, middle, sensors, true, Elsewhere::kAsInTheMap, progress);
  const TileGains together =
      GainsOfTile(map, map.models, middle, sensors, true, Elsewhere::kExplained, progress);
  double sum_alone = 0, sum_together = 0;
  for (std::int32_t cell = 0; cell < 100; ++cell) {
    sum_alone += alone.gains.GainOf(cell);
    sum_together += together.gains.GainOf(cell);
  }
  EXPECT_LT(sum_together, sum_alone - 100);
}

// The difference of a cell is a sum over readings: without those of the scans that the map is checked with it
// is what a log that never had them says.
TEST(CertaintyOfTile, TellsWhatTheReadingsContributeThatTheMapIsCheckedWith) {
  NoProgress progress;
  const Room room{.scans = 200, .beams = 12};
  MapState map = EmptyMapOf(room, 0.2);
  for (std::size_t cell = 0; cell < map.occupied.size(); cell += 7) map.occupied[cell] = 1;
  const Tile all{0, 0, static_cast<std::int32_t>(map.box.columns), static_cast<std::int32_t>(map.box.rows)};
  std::vector<RangeScans> sensors = SensorsOf(room);
  const Certainty whole = CertaintyOfTile({}, map, all, sensors, progress);
  sensors[0].held_out = sensors[0].checked;
  const Certainty without = CertaintyOfTile({}, map, all, sensors, progress);
  double taken_out = 0;
  for (std::size_t cell = 0; cell < whole.difference_nats.size(); ++cell) {
    EXPECT_EQ(without.of_checked_nats[cell], 0);
    taken_out = std::max(taken_out, std::abs(whole.of_checked_nats[cell]));
    if (std::isnan(without.difference_nats[cell])) continue;
    EXPECT_NEAR(whole.difference_nats[cell] - whole.of_checked_nats[cell], without.difference_nats[cell],
                1e-9);
  }
  EXPECT_GT(taken_out, 1);
}

}  // namespace
}  // namespace cairn::forward_map
