#include "pipelines/forward_map/flip_gains.h"

#include <gtest/gtest.h>

#include "pipelines/forward_map/testing.h"

namespace cairn::forward_map {
namespace {

// The incremental kernel against the model written as in the paper, along random walks through all maps.
TEST(FlipGains, AreTheDifferencesOfTheLogLikelihoodAlongAnyPath) {
  int looked_at = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    TinyWorld world{.readings = 30, .seed = seed};
    world.model.p_lost = seed % 2 == 0 ? 0 : 0.1;
    world.Make();
    for (std::size_t i = 0; i < world.data.size(); i += 5) {  // obstacles of other tiles
      for (std::size_t k = 0; k < world.data[i].beam.size(); k += 2) world.data[i].beam[k].cell = kElsewhere;
    }
    std::vector<std::uint8_t> map = world.truth;
    FlipGains gains = GainsOf(world.data, map, world.model);
    Rng rng(seed);
    for (int step = 0; step < 40; ++step) {
      const double now = LogLikelihood(world.data, map, world.model);
      for (std::size_t cell = 0; cell < map.size(); ++cell) {
        map[cell] ^= 1;
        EXPECT_NEAR(gains.GainOf(static_cast<std::int32_t>(cell)),
                    LogLikelihood(world.data, map, world.model) - now, 1e-9);
        map[cell] ^= 1;
        ++looked_at;
      }
      const std::uint64_t cell = rng.Below(map.size());
      map[cell] ^= 1;
      gains.Flip(static_cast<std::int32_t>(cell));
      EXPECT_EQ(gains.occupied(), map);
    }
  }
  EXPECT_EQ(looked_at, 20 * 40 * 16);
}

// One beam of five cells 1 m apart that measures 3 m, by hand.
TEST(FlipGains, OfOneBeamByHand) {
  const SensorModel model{.p_hit = 0.5, .p_rand = 0.1, .sigma_m = 0.1, .no_echo_m = 0.1, .z_max_m = 10};
  const std::vector<BeamReading> readings = {{3, {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 5}}}};
  FlipGains gains = GainsOf(readings, {0, 0, 0, 0, 0}, model);
  const double floor = 0.01, peak = 0.9 * 0.5 * 3.989422804014327;
  EXPECT_EQ(gains.near_ends(), std::vector<std::int32_t>{2});
  EXPECT_NEAR(gains.GainOf(2), std::log((floor + peak) / floor), 1e-12);
  EXPECT_EQ(gains.GainOf(1), 0);  // a reading of nothing is none the worse for what it passes
  gains.Flip(2);
  EXPECT_NEAR(gains.GainOf(1), std::log((floor + peak / 2) / (floor + peak)), 1e-12);
  EXPECT_EQ(gains.GainOf(3), 0);  // behind the reading
  EXPECT_FALSE(gains.Seen(3));
  EXPECT_TRUE(gains.Seen(0));
  gains.Flip(0);
  EXPECT_NEAR(gains.GainOf(0), std::log((floor + peak) / (floor + peak / 2)), 1e-12);
  EXPECT_NEAR(gains.GainOf(2), std::log(floor / (floor + peak / 2)), 1e-12);
}

// Two obstacles, as far before the reading as behind it, by hand: of the first, of the second by a beam that
// missed the first, or of chance.
TEST(FlipGains, LooksShareAReadingAmongItsObstaclesAndChance) {
  const SensorModel model{.p_hit = 0.5, .p_rand = 0.1, .sigma_m = 0.1, .no_echo_m = 0.1, .z_max_m = 10};
  const FlipGains gains = GainsOf({{3, {{0, 2.9}, {1, 3.1}, {2, 9}}}}, {1, 1, 0}, model);
  const double floor = 0.01, first = 0.9 * 0.5 * 2.4197072451914337, second = first / 2;
  const double all = floor + first + second;
  const std::vector<FlipGains::Look> near = gains.LooksAt(0), far = gains.LooksAt(1);
  ASSERT_EQ(near.size(), 1U);
  EXPECT_NEAR(near[0].caught, first / all, 1e-12);
  EXPECT_NEAR(near[0].missed, second / all, 1e-12);
  ASSERT_EQ(far.size(), 1U);
  EXPECT_NEAR(far[0].caught, second / all, 1e-12);
  EXPECT_NEAR(far[0].missed, 0, 1e-12);
}

// A reading without echo looks at all cells up to the sensor's reach.
TEST(FlipGains, OfNoEchoLoseByEveryObstacle) {
  const SensorModel model{.p_hit = 0.5, .p_rand = 0.1, .sigma_m = 0.1, .no_echo_m = 0.1, .z_max_m = 10};
  FlipGains gains = GainsOf({{10, {{0, 1}, {1, 9.9}}}}, {0, 0}, model);
  const double floor = 0.01, none = 0.9 * 3.989422804014327;
  EXPECT_NEAR(gains.GainOf(0), std::log((floor + none / 2) / (floor + none)), 1e-12);
  EXPECT_NEAR(gains.GainOf(1), std::log((floor + none / 2 + none * 0.5 * std::exp(-0.5)) / (floor + none)),
              1e-12);
}

// What the search may skip: a cell whose gain has changed has a reading that has.
TEST(FlipGains, ChangeOnlyWithAReadingOfTheCell) {
  int changed = 0, same = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const TinyWorld world = TinyWorld{.columns = 8, .rows = 8, .readings = 20, .seed = seed}.Make();
    FlipGains gains = GainsOf(world.data, world.truth, world.model);
    Rng rng(seed);
    for (int step = 0; step < 20; ++step) {
      std::vector<double> before;
      for (std::int32_t cell = 0; cell < 64; ++cell) before.push_back(gains.GainOf(cell));
      const std::uint64_t kept = gains.kept();
      const auto flipped = static_cast<std::int32_t>(rng.Below(64));
      gains.Flip(flipped);
      gains.Flip(flipped);  // taken back
      for (std::int32_t cell = 0; cell < 64; ++cell) {
        EXPECT_FALSE(gains.ChangedSince(cell, kept));
        EXPECT_EQ(gains.GainOf(cell), before[static_cast<std::size_t>(cell)]);
      }
      gains.Flip(flipped);
      gains.Keep(flipped);
      for (std::int32_t cell = 0; cell < 64; ++cell) {
        const bool may_differ = gains.ChangedSince(cell, kept);
        (may_differ ? changed : same) += 1;
        if (may_differ) continue;
        EXPECT_EQ(gains.GainOf(cell), before[static_cast<std::size_t>(cell)]);
      }
    }
  }
  EXPECT_GT(changed, 1000);
  EXPECT_GT(same, 1000);
}

TEST(FlipGains, CellsThatShareAWindow) {
  const SensorModel model{.sigma_m = 0.2};
  FlipGains gains = GainsOf({{3, {{0, 1}, {1, 2.5}, {2, 3}}}, {2, {{3, 1.9}, {2, 2}}}}, {0, 0, 0, 0}, model);
  EXPECT_EQ(gains.Sharing(2), (std::vector<std::int32_t>{1, 3}));
  EXPECT_EQ(gains.Sharing(1), (std::vector<std::int32_t>{2}));
  EXPECT_TRUE(gains.Sharing(0).empty());
}

}  // namespace
}  // namespace cairn::forward_map
