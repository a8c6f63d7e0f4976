// Three thousand worlds, in a few seconds. A failing one is replayed by the command that its message gives.
#include <gtest/gtest.h>

#include "tests/simulation/world.h"

namespace cairn::simulation {
namespace {

constexpr std::uint64_t kWorlds = 3000;

TEST(Simulation, EveryJobOfThreeThousandTroubledWorldsEndsAsIfUndisturbed) {
  Outcome sum;
  for (std::uint64_t seed = 1; seed <= kWorlds; ++seed) {
    const Outcome outcome = World(seed, {}).Run();
    ASSERT_EQ(outcome.violation, "") << "cairn-sim --first " << seed << " --seeds 1 --trace";
    sum.coordinator_crashes += outcome.coordinator_crashes;
    sum.worker_ends += outcome.worker_ends;
    sum.messages_lost += outcome.messages_lost;
    sum.failed_saves += outcome.failed_saves;
    sum.damaged += outcome.damaged;
  }
  // The worlds were troubled indeed.
  EXPECT_GT(sum.coordinator_crashes, kWorlds / 2);
  EXPECT_GT(sum.worker_ends, kWorlds);
  EXPECT_GT(sum.messages_lost, 10 * kWorlds);
  EXPECT_GT(sum.failed_saves, kWorlds / 10);
  EXPECT_GT(sum.damaged, kWorlds / 20);
}

TEST(Simulation, ASeedReplaysEventForEvent) {
  const auto trace = [](std::uint64_t seed) {
    std::string lines;
    World(seed, [&lines](double now_s, const std::string& line) {
      lines += std::to_string(now_s) + " " + line + "\n";
    }).Run();
    return lines;
  };
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const std::string once = trace(seed);
    EXPECT_GT(once.size(), 1000u);
    EXPECT_EQ(once, trace(seed));
  }
  EXPECT_NE(trace(1), trace(2));
}

TEST(Toy, TheOrderOfPartialsMatters) {
  wire::Assign assign;
  const proto::Job job = MakeToyJob(1, 1, 5, 5, false);
  *assign.mutable_stage() = job.stages(0);
  (*assign.mutable_state()->mutable_scalars())["round"].set_i(0);
  assign.mutable_key()->set_kind(wire::TaskKey::ADVANCE);
  assign.add_partials("a");
  assign.add_partials("b");
  const auto one = coordinator::HashOfStep(ComputeToy(assign).step);
  assign.mutable_partials()->SwapElements(0, 1);
  EXPECT_NE(coordinator::HashOfStep(ComputeToy(assign).step), one);
}

}  // namespace
}  // namespace cairn::simulation
