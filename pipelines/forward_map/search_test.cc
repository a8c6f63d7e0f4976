#include "pipelines/forward_map/search.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>

#include "pipelines/forward_map/testing.h"

namespace cairn::forward_map {
namespace {

void NoTick() {}

// How many of the worlds end in the best of all maps.
int CountOptimal(const std::vector<TinyWorld>& worlds, const std::vector<double>& best, const Moves& moves) {
  int optimal = 0;
  for (std::size_t w = 0; w < worlds.size(); ++w) {
    const TinyWorld& world = worlds[w];
    const Patch patch = Patch::Empty(world.columns, world.rows);
    FlipGains gains = GainsOf(world.data, patch.Inside(), world.model);
    const double gained = MapSearch(&gains, patch, {}).Run(moves, NoTick);
    const double end = LogLikelihood(world.data, gains.occupied(), world.model);
    EXPECT_NEAR(LogLikelihood(world.data, patch.Inside(), world.model) + gained, end, 1e-9);
    EXPECT_LT(end, best[w] + 1e-9);
    optimal += end > best[w] - 1e-9 ? 1 : 0;
  }
  return optimal;
}

// Wide cones that cross: the worlds in which flips get stuck.
TEST(MapSearch, EndsInTheBestOfAllMapsOfTinyWorlds) {
  std::vector<TinyWorld> worlds;
  std::vector<double> best;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    TinyWorld world{.columns = 4,
                    .rows = seed % 25 == 0 ? 4 : 3,
                    .readings = static_cast<int>(6 + seed % 20),
                    .occupied_share = seed % 2 == 0 ? 0.25 : 0.5,
                    .opening_rad = 1.5,
                    .seed = seed};
    world.model.p_hit = 0.3;
    worlds.push_back(world.Make());
    best.push_back(BestOfAllMaps(world));
  }
  const int flips = CountOptimal(worlds, best, {.swaps = false, .pairs = false});
  const int swaps = CountOptimal(worlds, best, {.swaps = true, .pairs = false});
  const int both = CountOptimal(worlds, best, {});
  EXPECT_GE(both, 95);
  EXPECT_GE(both, swaps);
  EXPECT_GT(swaps, flips);
}

// [Thr01] figure 1: a short reading whose arc is three cells, and a long one whose beam crosses one of them.
// A cell for itself is told 'occupied' by the one and 'free' by the other; a map that explains both has the
// obstacle elsewhere on the arc.
TEST(MapSearch, OfTwoCrossingConesHasNoConflictInTheOverlap) {
  const SensorModel model{.p_hit = 0.6, .p_rand = 0.05, .sigma_m = 0.1, .no_echo_m = 0.1, .z_max_m = 10};
  const std::vector<BeamReading> readings = {{2, {{0, 2}, {1, 2}, {2, 2}}}, {3, {{2, 1.5}, {3, 3}, {4, 3}}}};
  const Patch patch = Patch::Empty(5, 1);
  FlipGains gains = GainsOf(readings, patch.Inside(), model);
  MapSearch(&gains, patch, {}).Run({}, NoTick);
  EXPECT_EQ(gains.occupied(), (std::vector<std::uint8_t>{1, 1, 0, 1, 1}));
}

// The search looks again only at what has changed: it must not overlook what gains.
TEST(MapSearch, LeavesNoFlipAndNoSwapThatGains) {
  int swaps = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const TinyWorld world = TinyWorld{.columns = 7, .rows = 6, .readings = 90, .seed = seed}.Make();
    const Patch patch = Patch::Empty(world.columns, world.rows);
    FlipGains gains = GainsOf(world.data, patch.Inside(), world.model);
    MapSearch search(&gains, patch, {});
    search.Run({.swaps = true, .pairs = false}, NoTick);
    for (std::int32_t cell = 0; cell < patch.cells(); ++cell) {
      const double gain = search.GainOf(cell);
      EXPECT_LE(gain, 1e-9);
      if (search.occupied(cell) == 0) continue;
      gains.Flip(cell);
      for (std::int32_t other = 0; other < patch.cells(); ++other) {
        const std::int32_t columns = std::abs(other % 7 - cell % 7), rows = std::abs(other / 7 - cell / 7);
        if (std::max(columns, rows) != 1 || search.occupied(other) != 0) continue;
        EXPECT_LE(gain + gains.GainOf(other), 1e-9) << seed << ": " << cell << " to " << other;
        ++swaps;
      }
      gains.Flip(cell);
    }
  }
  EXPECT_GT(swaps, 1000);
}

TEST(MapSearch, OfNoReadingsLeavesTheMapEmpty) {
  const Patch patch = Patch::Empty(3, 3);
  FlipGains gains = GainsOf({}, patch.Inside(), {});
  EXPECT_EQ(MapSearch(&gains, patch, {}).Run({}, NoTick), 0);
  EXPECT_EQ(gains.occupied(), patch.Inside());
}

// The prior alone, by hand: a hole in a full map costs its four sides.
TEST(MapSearch, WeighsThePriorsOfTheCells) {
  Patch patch = Patch::Empty(3, 3);
  for (std::size_t at = 0; at < patch.rimmed.size(); ++at) patch.rimmed[at] = at == patch.Rimmed(4) ? 0 : 1;
  FlipGains gains = GainsOf({}, patch.Inside(), {});
  MapSearch search(&gains, patch, {.logit = -1, .smoothness = 0.5});
  EXPECT_NEAR(search.GainOf(4), -1 + 4 * 0.5, 1e-12);
  EXPECT_NEAR(search.GainOf(1), 1 - 2 * 0.5, 1e-12);
  EXPECT_NEAR(search.Climb(NoTick), 1, 1e-12);
}

// Few cells may gain by a reading's end, and a prior against obstacles leaves out those that gain little.
TEST(MapSearch, APriorAgainstObstaclesLeavesOutWhatOneReadingTells) {
  const SensorModel model{.p_hit = 0.6, .p_rand = 0.05, .sigma_m = 0.1, .no_echo_m = 0.1, .z_max_m = 10};
  for (const double logit : {0.0, -10.0}) {
    const Patch patch = Patch::Empty(2, 1);
    FlipGains gains = GainsOf({{2, {{0, 1}, {1, 2}}}}, patch.Inside(), model);
    MapSearch(&gains, patch, {.logit = logit}).Run({}, NoTick);
    EXPECT_EQ(gains.occupied()[1], logit == 0 ? 1 : 0);
  }
}

}  // namespace
}  // namespace cairn::forward_map
