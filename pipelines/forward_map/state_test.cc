#include "pipelines/forward_map/state.h"

#include <gtest/gtest.h>

#include "pipelines/forward_map/tile_task.h"
#include "schema/rng.h"

namespace cairn::forward_map {
namespace {

MapState SomeMap() {
  MapState map{{-1, 2, 0.5, 5, 4}, std::vector<std::uint8_t>(20), {{.p_hit = 0.3}, {.sigma_m = 0.7}}};
  Rng rng(3);
  for (std::uint8_t& cell : map.occupied) cell = rng.Uniform() < 0.4 ? 1 : 0;
  return map;
}

TEST(MapState, ComesBackFromItsBlob) {
  const MapState map = SomeMap(), back = Read<MapState>(BlobOf(map));
  EXPECT_EQ(back.occupied, map.occupied);
  EXPECT_EQ(back.models, map.models);
  EXPECT_EQ(back.box.origin_x_m, -1);
  EXPECT_EQ(back.box.rows, 4);
}

// The prior of a whole map against the search's own sums of single flips, at borders and corners too.
TEST(MapState, LogPriorChangesAsTheSearchSaysOfEachFlip) {
  MapState map = SomeMap();
  const MapPrior prior{.logit = -0.7, .smoothness = 0.3};
  Patch patch = Patch::Empty(5, 4);
  for (std::int32_t cell = 0; cell < 20; ++cell)
    patch.rimmed[patch.Rimmed(cell)] = map.occupied[static_cast<std::size_t>(cell)];
  FlipGains gains(20, {{}});
  gains.Start(patch.Inside());
  const MapSearch search(&gains, patch, prior);
  for (std::int32_t cell = 0; cell < 20; ++cell) {
    const double before = map.LogPrior(prior);
    map.occupied[static_cast<std::size_t>(cell)] ^= 1;
    EXPECT_NEAR(map.LogPrior(prior) - before, search.GainOf(cell), 1e-12) << cell;
    map.occupied[static_cast<std::size_t>(cell)] ^= 1;
  }
}

TEST(Proposals, ComeBackAndAreAppliedInOrder) {
  const std::vector<Proposal> proposals = ProposalsOf(ToBlob({{{1, 3}, 2.5}, {{}, 0}, {{3, 4}, 1}}));
  ASSERT_EQ(proposals.size(), 3U);
  EXPECT_EQ(proposals[0].gain, 2.5);
  std::vector<std::uint8_t> map(5);
  Apply(proposals, 1, &map);
  EXPECT_EQ(map, (std::vector<std::uint8_t>{0, 1, 0, 1, 0}));
  Apply({proposals[2]}, 1, &map);
  EXPECT_EQ(map, (std::vector<std::uint8_t>{0, 1, 0, 0, 1}));
}

}  // namespace
}  // namespace cairn::forward_map
