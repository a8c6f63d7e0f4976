#include "pipelines/landmark_map/refinement/broken_motion.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "pipelines/landmark_map/refinement/testing.h"

namespace cairn::landmark_map {
namespace {

TEST(BrokenMotion, IsFoundWhereWheelsStoodStill) {
  EightWorld world(3, 0.01, 1.02);
  // Thirty motions in which nothing is seen, and of which odometry has a row that says nothing.
  constexpr int kFrom = 100, kTo = 130, kGone = kTo - kFrom - 1;
  NodeTrack& track = world.problem.robots[0];
  std::erase_if(world.problem.sightings,
                [](const Sighting& seen) { return seen.node > kFrom && seen.node < kTo; });
  for (Sighting& seen : world.problem.sightings)
    if (seen.node >= kTo) seen.node -= kGone;
  const auto erase = [](auto* of) { of->erase(of->begin() + kFrom + 1, of->begin() + kTo); };
  erase(&track.time_s);
  erase(&track.controls);
  erase(&world.truth.nodes[0]);
  track.controls[kFrom] = {{0.0, 0.0}};
  const auto cost = [&](const LeastSquaresEnd& end) { return NegativeLogDensity(world.problem, end.point); };
  const LeastSquaresEnd bent = Descend(world.problem, world.Reckoned());
  const std::vector<BrokenMotion> motions = FindBrokenMotions(world.problem, bent.point, 6);
  ASSERT_EQ(motions.size(), 6U);
  EXPECT_NE(std::ranges::find(motions, static_cast<std::size_t>(kFrom), &BrokenMotion::edge), motions.end());
  EXPECT_GT(motions[0].gain_nats, 100.0);
  const double as_it_is = cost(bent);
  track.broken = {static_cast<std::size_t>(kFrom)};
  const LeastSquaresEnd freed = Descend(world.problem, bent.point);
  EXPECT_GT(as_it_is - cost(freed), 100.0);
  EXPECT_LT((freed.point.nodes[0][150] - world.truth.nodes[0][150]).head<2>().norm(), 0.3);
}

TEST(BrokenMotion, NonePromisesMuchWhereOdometryErrsAsItSays) {
  for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6}) {
    const EightWorld world(seed, 0.01, 1.02);
    const LeastSquaresEnd end = Descend(world.problem, world.truth);
    const std::vector<BrokenMotion> motions = FindBrokenMotions(world.problem, end.point, 1);
    ASSERT_EQ(motions.size(), 1U);
    EXPECT_GT(motions[0].gain_nats, 0.0);
    EXPECT_LT(motions[0].gain_nats, 15.0) << seed;
  }
}

}  // namespace
}  // namespace cairn::landmark_map
