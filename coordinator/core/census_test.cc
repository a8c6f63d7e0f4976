#include "coordinator/core/census.h"

#include "coordinator/core/testing/core_fixture.h"

namespace cairn::coordinator {
namespace {

TEST(Histogram, EachIsCountedInTheFirstBucketWhoseBoundItDoesNotExceed) {
  Histogram histogram;
  for (const double seconds : {0.0, 0.001, 0.0011, 1e9}) histogram.Add(seconds);
  EXPECT_EQ(histogram.counts[0], 2u);
  EXPECT_EQ(histogram.counts[1], 1u);
  EXPECT_EQ(histogram.counts.back(), 1u);
  EXPECT_DOUBLE_EQ(histogram.sum_s, 1e9 + 0.0021);
}

TEST(Census, OfNothingNamesEveryState) {
  const Census census = CoreFixture().core.TakeCensus();
  EXPECT_EQ(census.jobs.size(), 6u);
  EXPECT_EQ(census.workers.size(), 4u);
  for (const auto& [state, count] : census.jobs) EXPECT_EQ(count, 0u) << state;
}

TEST(Census, TasksAreWaitingThenRunningThenDoneAndTheJobsStateFollows) {
  CoreFixture fixture;
  fixture.Submit();
  EXPECT_EQ(fixture.core.TakeCensus().jobs["queued"], 1u);
  EXPECT_EQ(fixture.core.TakeCensus().tasks_waiting, 1u) << "the START";
  fixture.Do(PersistDone{"a", 1});
  fixture.Join("w", 2);
  fixture.AnswerPlan(fixture.Next(), TestStep(5));
  Census census = fixture.core.TakeCensus();
  EXPECT_EQ(census.jobs["running"], 1u);
  EXPECT_EQ(census.workers["busy"], 1u);
  EXPECT_EQ(census.tasks_running, 2u);
  EXPECT_EQ(census.tasks_waiting, 3u);
  EXPECT_EQ(fixture.core.tally().tasks_done, 1u);
  EXPECT_EQ(fixture.core.tally().checkpoints, 1u);
  fixture.Do(PauseJob{"a"});
  census = fixture.core.TakeCensus();
  EXPECT_EQ(census.jobs["paused"], 1u);
  EXPECT_EQ(census.tasks_waiting, 0u) << "nobody waits for what is paused";
}

TEST(Census, WhatWaitsIsToldInSecondsOfWorkByWhatWasDone) {
  CoreFixture fixture;
  Begin(fixture, 5);
  EXPECT_DOUBLE_EQ(fixture.core.TakeCensus().waiting_work_s, 4) << "a second each, while nothing is known";
  fixture.now_s += 7;
  fixture.AnswerRun(fixture.Next(), H(1));
  EXPECT_DOUBLE_EQ(fixture.core.TakeCensus().waiting_work_s, 3 * 7);
  for (unsigned task = 2; task < 5; ++task) fixture.AnswerRun(fixture.Next(), H(task));
  EXPECT_DOUBLE_EQ(fixture.core.TakeCensus().waiting_work_s, 0) << "the last one runs";
}

TEST(Tally, CountsRetriesRoundsAndWhatCouldNotBeSaved) {
  CoreFixture fixture;
  Begin(fixture, 1);
  fixture.Fail(fixture.Next(), "out of luck");
  fixture.Advance(0.2);
  fixture.AnswerRun(fixture.Next(), H(1));
  fixture.AnswerResult(fixture.Next(), H(2));
  const Tally& tally = fixture.core.tally();
  EXPECT_EQ(tally.retries, 1u);
  EXPECT_EQ(tally.tasks_done, 3u);
  EXPECT_EQ(tally.rounds.counts[0], 1u) << "the START";
  EXPECT_EQ(tally.rounds.counts[5], 1u) << "a round of 0.2 s";
  ASSERT_EQ(fixture.All<Persist>().size(), 1u);
  fixture.Do(PersistFailed{"a", fixture.All<Persist>()[0].checkpoint.number(), "a full disk"});
  EXPECT_EQ(tally.checkpoint_failures, 1u);
}

}  // namespace
}  // namespace cairn::coordinator
