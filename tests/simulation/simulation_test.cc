// Three thousand worlds, in a few seconds. A failing one is replayed by the command that its message gives.
#include <gtest/gtest.h>

#include "tests/simulation/world.h"

namespace cairn::simulation {
namespace {

constexpr std::uint64_t kWorlds = 3000;

TEST(Simulation, EveryJobOfThreeThousandTroubledWorldsEndsAsIfUndisturbed) {
  Coverage sum{};
  for (std::uint64_t seed = 1; seed <= kWorlds; ++seed) {
    const Outcome outcome = World(seed, {}).Run();
    ASSERT_EQ(outcome.violation, "") << "cairn-sim --first " << seed << " --seeds 1 --trace";
    for (std::size_t mark = 0; mark < sum.size(); ++mark) sum[mark] += outcome.coverage[mark];
  }
  // The worlds were troubled indeed: every fault and every transition came up, and not by a single chance.
  for (std::size_t mark = 0; mark < sum.size(); ++mark) EXPECT_GE(sum[mark], 10u) << kMarkTexts[mark];
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
  const proto::Job job = MakeToyJob(1, 1, 5, 5, ToyKind::kGood);
  *assign.mutable_stage() = job.stages(0);
  (*assign.mutable_state()->mutable_scalars())["round"].set_i(0);
  assign.mutable_key()->set_kind(wire::TaskKey::ADVANCE);
  assign.add_partials("a");
  assign.add_partials("b");
  const auto one = coordinator::HashOfStep(ComputeToy(assign).step);
  assign.mutable_partials()->SwapElements(0, 1);
  EXPECT_NE(coordinator::HashOfStep(ComputeToy(assign).step), one);
}

// The model of the disk, as power cuts find it.
TEST(DiskModel, WhatWasNotSyncedIsGoneOrTorn) {
  FolderModel<int, int> folder;
  const auto until = [](DiskStep last) {
    return [last](DiskStep step) { return step > last ? DiskOutcome::kDead : DiskOutcome::kOk; };
  };
  EXPECT_EQ(folder.Write(1, 10, until(DiskStep::kSyncFolder)), DiskOutcome::kOk);
  EXPECT_EQ(folder.Write(1, 20, until(DiskStep::kSyncFile)), DiskOutcome::kDead);
  EXPECT_EQ(*folder.Read(1), 10) << "before it is renamed nothing shows";
  EXPECT_EQ(folder.Write(1, 30, until(DiskStep::kRename)), DiskOutcome::kDead);
  EXPECT_EQ(*folder.Read(1), 30);
  folder.CutPower([] { return false; });
  EXPECT_EQ(*folder.Read(1), 10) << "the folder was not synced";
  folder.Remove(1);
  EXPECT_EQ(folder.Read(1), nullptr);
  folder.CutPower([] { return false; });
  EXPECT_EQ(*folder.Read(1), 10) << "nor was it after the removal";
  folder.Damage(1);
  EXPECT_EQ(folder.Read(1), nullptr);
}

}  // namespace
}  // namespace cairn::simulation
