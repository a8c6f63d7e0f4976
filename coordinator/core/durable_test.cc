// Nothing is acknowledged before it is durable, and what cannot be made durable did not happen.
#include <gtest/gtest.h>

#include "coordinator/core/core_bench.h"

namespace cairn::coordinator {
namespace {

// "me: ok" or "me: why not", of the last event.
std::vector<std::string> Told(const Bench& bench) {
  std::vector<std::string> told;
  for (const Answer& answer : bench.All<Answer>())
    told.push_back(answer.asker + ": " + (answer.refusal.empty() ? "ok" : answer.refusal));
  return told;
}

using Lines = std::vector<std::string>;

TEST(CoreDurable, ASubmissionIsAnsweredWhenItIsSavedNotBefore) {
  Bench bench;
  bench.Do(SubmitJob{"a", TestJob(), {}, "me"});
  EXPECT_EQ(Told(bench), Lines{});
  bench.Do(SubmitJob{"a", TestJob(), {}, "you"});
  EXPECT_EQ(Told(bench), Lines{}) << "told twice: it is no more durable than before";
  bench.Do(PersistDone{"a", 1});
  EXPECT_EQ(Told(bench), (Lines{"me: ok", "you: ok"}));
  bench.Do(SubmitJob{"a", TestJob(), {}, "she"});
  EXPECT_EQ(Told(bench), Lines{"she: ok"});
}

TEST(CoreDurable, ASubmissionThatCannotBeSavedIsRefusedAndTheJobIsGone) {
  Bench bench;
  bench.Join("w");
  bench.Do(SubmitJob{"a", TestJob(), {H(1000)}, "me"});
  bench.Next();  // its start is with a worker already
  bench.Do(SubmitJob{"a", TestJob(), {}, "you"});
  bench.Do(PauseJob{"a", "she"});
  bench.Do(PersistFailed{"a", 1, "no space"});
  const std::string refusal = ": cannot save: no space; the job was not taken";
  EXPECT_EQ(Told(bench), (Lines{"me" + refusal, "you" + refusal, "she" + refusal}));
  EXPECT_EQ(bench.core.FindJob("a"), nullptr);
  EXPECT_EQ(bench.Sent(&wire::Envelope::has_cancel).size(), 1u);
  EXPECT_EQ(bench.All<ForgetJob>().size(), 1u);
  EXPECT_EQ(bench.core.held_blobs(), 0u);
  bench.Do(ForgetDone{"a"});
  EXPECT_FALSE(bench.core.HasUnsaved());
  bench.Do(SubmitJob{"a", TestJob(), {}, "me"});
  bench.Do(PersistDone{"a", 1});
  EXPECT_EQ(Told(bench), Lines{"me: ok"}) << "once there is room";
}

TEST(CoreDurable, ACommandIsAnsweredByTheCheckpointThatHoldsItNotByTheOneUnderWay) {
  Bench bench;
  Begin(bench, 2);
  bench.Advance(1.1);
  ASSERT_EQ(bench.All<Persist>().size(), 1u);
  bench.Do(PrioritizeJob{"a", 3, "me"});
  bench.Do(PersistDone{"a", 2});
  EXPECT_EQ(Told(bench), Lines{});
  ASSERT_EQ(bench.All<Persist>().size(), 1u);
  EXPECT_EQ(bench.All<Persist>()[0].checkpoint.job().priority(), 3);
  bench.Do(PersistDone{"a", 3});
  EXPECT_EQ(Told(bench), Lines{"me: ok"});
}

const Lines kTakenBack = {"me: cannot save: no space; a is as it was before"};

TEST(CoreDurable, APauseThatCannotBeSavedIsTakenBack) {
  Bench bench;
  Begin(bench, 2);
  bench.Do(PauseJob{"a", "me"});
  bench.Do(PersistFailed{"a", 2, "no space"});
  EXPECT_EQ(Told(bench), kTakenBack);
  EXPECT_FALSE(bench.core.FindJob("a")->held);
  EXPECT_EQ(bench.Info().reason(), "cannot save: no space") << "for the disk, and over at the next start";
}

TEST(CoreDurable, ACancelThatCannotBeSavedIsTakenBackAndTheJobCanGoOn) {
  Bench bench;
  Begin(bench, 2, 2);
  bench.AnswerRun(bench.Next(), H(10));
  bench.Next();
  bench.Do(CancelJob{"a", "me"});
  EXPECT_EQ(bench.Info().state(), "cancelled");
  bench.Do(PersistFailed{"a", 2, "no space"});
  EXPECT_EQ(Told(bench), kTakenBack);
  EXPECT_EQ(bench.Info().state(), "paused");
  bench.Do(ResumeJob{"a", "me"});
  bench.Do(PersistDone{"a", 3});
  EXPECT_EQ(Told(bench), Lines{"me: ok"});
  const auto task = bench.Next();
  EXPECT_EQ(task.assign.key().task(), 1u) << "what was done is not done again";
  bench.AnswerRun(task, H(11));
  EXPECT_EQ(bench.Next().assign.partials(0), H(10).Binary());
}

TEST(CoreDurable, AResumeThatCannotBeSavedLeavesTheJobPausedByItsOwner) {
  Bench bench;
  Begin(bench, 2);
  bench.Do(PauseJob{"a", "me"});
  bench.Do(PersistDone{"a", 2});
  bench.Do(ResumeJob{"a", "me"});
  EXPECT_EQ(bench.Info().state(), "running");
  bench.Do(PersistFailed{"a", 3, "no space"});
  EXPECT_EQ(Told(bench), kTakenBack);
  EXPECT_EQ(bench.Info().reason(), "paused by its owner");
  EXPECT_TRUE(bench.core.FindJob("a")->held);
}

TEST(CoreDurable, ARetryThatCannotBeSavedLeavesTheJobFailedWithItsReason) {
  Bench bench;
  Begin(bench, 1);
  bench.Fail(bench.Next(), "no good", true);
  bench.Do(PersistDone{"a", 2});
  const std::string reason = bench.Info().reason();
  bench.Do(RetryJob{"a", "me"});
  bench.Next();
  bench.Do(PersistFailed{"a", 3, "no space"});
  EXPECT_EQ(Told(bench), kTakenBack);
  EXPECT_EQ(bench.Info().state(), "failed");
  EXPECT_EQ(bench.Info().reason(), reason);
  EXPECT_TRUE(bench.Info().input_error());
  EXPECT_EQ(bench.Sent(&wire::Envelope::has_cancel).size(), 1u);
  bench.Do(RetryJob{"a", "me"});
  EXPECT_EQ(bench.Next().assign.key().kind(), wire::TaskKey::RUN);
}

TEST(CoreDurable, WhatWasAskedMeanwhileIsTakenBackWithIt) {
  Bench bench;
  Begin(bench, 2);
  bench.Do(PrioritizeJob{"a", 3, "me"});
  bench.Do(CancelJob{"a", "you"});
  bench.Do(CancelJob{"a", "she"});
  bench.Do(PersistFailed{"a", 2, "no space"});
  EXPECT_EQ(Told(bench).size(), 3u);
  EXPECT_EQ(bench.Info().priority(), 0);
  EXPECT_EQ(bench.Info().state(), "paused");
}

TEST(CoreDurable, AJobThatFailsMeanwhileStaysFailed) {
  Bench bench;
  Begin(bench, 2);
  const auto task = bench.Next();
  bench.Do(PauseJob{"a", "me"});
  bench.Fail(task, "no good", true);
  bench.Do(PersistFailed{"a", 2, "no space"});
  EXPECT_EQ(Told(bench), kTakenBack);
  EXPECT_EQ(bench.Info().state(), "failed");
}

// As a priority of a job that stands still because the disk is full.
TEST(CoreDurable, ACommandToAJobThatWaitsForTheDiskIsTriedNotJustAcknowledged) {
  Bench bench;
  Begin(bench, 2);
  bench.Advance(1.1);
  bench.Do(PersistFailed{"a", 2, "no space"});
  bench.Do(PrioritizeJob{"a", 3, "me"});
  EXPECT_EQ(Told(bench), Lines{});
  ASSERT_EQ(bench.All<Persist>().size(), 1u);
  bench.Do(PersistFailed{"a", 3, "no space"});
  EXPECT_EQ(Told(bench), kTakenBack);
  EXPECT_EQ(bench.Info().priority(), 0);
  bench.Advance(9);
  EXPECT_TRUE(bench.All<Persist>().empty()) << "it waits again";
}

TEST(CoreDurable, AJobThatIsDoneButForItsEndIsDoneAfterARestartThoughItWasSavedAsPaused) {
  Bench before;
  before.Submit();
  before.Do(PersistDone{"a", 1});
  before.Join("w");
  before.AnswerResult(before.Next(), H(20));
  before.Do(PersistFailed{"a", 2, "no space"});
  before.Do(PrioritizeJob{"a", 3, "me"});
  ASSERT_EQ(before.All<Persist>().size(), 1u);
  const proto::Checkpoint paused = before.All<Persist>()[0].checkpoint;
  EXPECT_EQ(paused.state(), proto::JOB_PAUSED);
  Bench after;
  after.Do(RestoreJob{paused, {}});
  ASSERT_EQ(after.All<Persist>().size(), 1u);
  EXPECT_EQ(after.All<Persist>()[0].checkpoint.state(), proto::JOB_DONE);
  after.Do(PersistDone{"a", 4});
  EXPECT_EQ(after.Info().state(), "done");
}

TEST(CoreDurable, AJobIsDeletedWhenTheDiskHasForgottenIt) {
  Bench bench;
  Begin(bench, 1);
  bench.Fail(bench.Next(), "no good", true);
  bench.Do(PersistDone{"a", 2});
  bench.Do(DeleteJob{"a", "me"});
  bench.Do(DeleteJob{"a", "you"});
  EXPECT_TRUE(bench.All<ForgetJob>().empty()) << "it was asked to already";
  bench.Do(RetryJob{"a", "she"});
  EXPECT_EQ(Told(bench), Lines{"she: it is being deleted"});
  bench.Do(ForgetFailed{"a", "no space"});
  EXPECT_EQ(Told(bench), (Lines{"me: cannot delete a: no space", "you: cannot delete a: no space"}));
  EXPECT_EQ(bench.Info().state(), "failed");
  bench.Do(DeleteJob{"a", "me"});
  EXPECT_TRUE(bench.core.HasUnsaved());
  bench.Do(ForgetDone{"a"});
  EXPECT_EQ(Told(bench), Lines{"me: ok"});
  EXPECT_EQ(bench.core.FindJob("a"), nullptr);
  EXPECT_EQ(bench.core.held_blobs(), 0u);
}

// Else its end would be written after all that there was of it went.
TEST(CoreDurable, AJobThatIsBeingDeletedIsNotSaved) {
  Bench bench;
  Begin(bench, 1);
  bench.Fail(bench.Next(), "no good", true);
  bench.Do(DeleteJob{"a", "me"});
  bench.Do(PersistFailed{"a", 2, "no space"});
  bench.Advance(9);
  EXPECT_TRUE(bench.All<Persist>().empty());
  bench.Do(ForgetFailed{"a", "no space"});
  bench.Advance(9);
  EXPECT_EQ(bench.All<Persist>().size(), 1u);
}

TEST(CoreDurable, ARefusalByTheRulesIsToldAtOnce) {
  Bench bench;
  Begin(bench, 1);
  bench.Do(RetryJob{"a", "me"});
  EXPECT_EQ(Told(bench), Lines{"me: it has not failed"});
  bench.Do(CancelJob{"nobody", "me"});
  EXPECT_EQ(Told(bench), Lines{"me: there is no job 'nobody'"});
}

}  // namespace
}  // namespace cairn::coordinator
