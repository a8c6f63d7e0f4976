#include "coordinator/core/fair_share.h"

#include <gtest/gtest.h>

#include <map>

namespace cairn::coordinator {
namespace {

// Serves `turns` turns; job -> seconds that it was given.
std::map<std::uint64_t, double> Serve(FairShare& share, int turns,
                                      const std::map<std::uint64_t, double>& task_s,
                                      const std::map<std::uint64_t, int>& priority = {}) {
  std::map<std::uint64_t, double> given;
  for (int i = 0; i < turns; ++i) {
    const std::uint64_t job = share.Next().value();
    given[job] += task_s.at(job);
    share.Charge(job, task_s.at(job), priority.contains(job) ? priority.at(job) : 0);
  }
  return given;
}

TEST(FairShare, EqualPrioritiesShareByWorkNotByTasks) {
  FairShare share;
  share.Offer(1);
  share.Offer(2);
  const auto given = Serve(share, 1100, {{1, 10.0}, {2, 1.0}});
  EXPECT_NEAR(given.at(1) / given.at(2), 1, 0.02);
}

TEST(FairShare, EachStepOfPriorityDoublesTheShareAndTheLeastIsNotStarved) {
  FairShare share;
  for (const std::uint64_t job : {1u, 2u, 3u}) share.Offer(job);
  const auto given = Serve(share, 7000, {{1, 1.0}, {2, 1.0}, {3, 1.0}}, {{2, 1}, {3, 2}});
  EXPECT_NEAR(given.at(2) / given.at(1), 2, 0.02);
  EXPECT_NEAR(given.at(3) / given.at(1), 4, 0.04);
  share.Offer(4);
  EXPECT_GT(Serve(share, 4000, {{1, 1.0}, {2, 1.0}, {3, 1.0}, {4, 1.0}}, {{3, 10}, {4, -1}})[4], 0);
}

TEST(FairShare, WhoComesLateOrComesBackHasSavedNothingUp) {
  FairShare share;
  share.Offer(1);
  share.Offer(2);
  share.Withdraw(2);
  Serve(share, 1000, {{1, 1.0}});
  share.Offer(2);
  share.Offer(3);
  const auto given = Serve(share, 30, {{1, 1.0}, {2, 1.0}, {3, 1.0}});
  for (const std::uint64_t job : {1u, 2u, 3u}) EXPECT_NEAR(given.at(job), 10, 1);
}

// A job that began last of all and is wanted soon does not wait for what its first turn weighed then.
TEST(FairShare, WhatAJobWasGivenCountsByThePriorityThatItHasNow) {
  FairShare share;
  share.Offer(1);
  share.Offer(2);
  share.Charge(1, 1, -10);
  Serve(share, 3, {{2, 1.0}});
  share.Reprioritize(1, -10, 10);
  EXPECT_GT(Serve(share, 30, {{1, 1.0}, {2, 1.0}}, {{1, 10}})[1], 25);
  share.Reprioritize(1, 10, -10);
  const auto given = Serve(share, 30, {{1, 1.0}, {2, 1.0}}, {{1, -10}});
  EXPECT_EQ(given.at(1), 1) << "the turn that it had waited for";
  share.Reprioritize(3, 0, 1);  // one that was never offered
}

TEST(FairShare, ATurnIsNeverFree) {
  FairShare share;
  share.Offer(1);
  share.Offer(2);
  const auto given = Serve(share, 10, {{1, 0.0}, {2, 0.0}});
  EXPECT_EQ(given.size(), 2u);
}

TEST(FairShare, WhatIsForgottenOrWithdrawnIsNeverNext) {
  FairShare share;
  EXPECT_EQ(share.Next(), std::nullopt);
  share.Offer(1);
  share.Offer(2);
  share.Forget(1);
  EXPECT_EQ(share.Next(), 2u);
  share.Withdraw(2);
  EXPECT_EQ(share.Next(), std::nullopt);
}

}  // namespace
}  // namespace cairn::coordinator
