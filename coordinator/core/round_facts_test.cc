#include "coordinator/core/round_facts.h"

#include <gtest/gtest.h>

namespace cairn::coordinator {
namespace {

proto::RoundFacts Row(int round) {
  proto::RoundFacts row;
  row.set_note("round " + std::to_string(round));
  row.set_tasks(2);
  row.set_seconds(0.5);
  row.set_compute_seconds(0.25);
  return row;
}

TEST(RoundFacts, StayFewAndAddUpToAllRounds) {
  constexpr int kRounds = 100'000;
  proto::StageFacts facts;
  AddRoundFacts(Row(-1), &facts);
  for (int round = 0; round < kRounds; ++round) {
    AddRoundFacts(Row(round), &facts);
    ASSERT_LE(facts.rounds_size(), kMostRoundFacts);
  }
  std::uint64_t rounds = 0, tasks = 0;
  double seconds = 0, compute = 0;
  for (const proto::RoundFacts& row : facts.rounds()) {
    rounds += row.rounds() == 0 ? 1 : row.rounds();
    tasks += row.tasks();
    seconds += row.seconds();
    compute += row.compute_seconds();
  }
  EXPECT_EQ(rounds, kRounds + 1U);
  EXPECT_EQ(tasks, 2U * (kRounds + 1U));
  EXPECT_DOUBLE_EQ(seconds, 0.5 * (kRounds + 1));
  EXPECT_DOUBLE_EQ(compute, 0.25 * (kRounds + 1));
}

TEST(RoundFacts, OfTheStartAndOfRecentRoundsKeepToThemselvesAndTheOrderStays) {
  proto::StageFacts facts;
  for (int round = 0; round <= kMostRoundFacts; ++round) AddRoundFacts(Row(round), &facts);
  ASSERT_LT(facts.rounds_size(), kMostRoundFacts);
  EXPECT_EQ(facts.rounds(0).note(), "round 0");
  EXPECT_EQ(facts.rounds(0).rounds(), 0U);
  EXPECT_EQ(facts.rounds(1).note(), "round 2");
  EXPECT_EQ(facts.rounds(1).rounds(), 2U);
  for (int back = 1; back <= kRecentRoundFacts; ++back) {
    const proto::RoundFacts& row = facts.rounds(facts.rounds_size() - back);
    ASSERT_EQ(row.note(), "round " + std::to_string(kMostRoundFacts + 1 - back));
    ASSERT_EQ(row.rounds(), 0U);
  }
}

}  // namespace
}  // namespace cairn::coordinator
