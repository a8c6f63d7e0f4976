// Nothing is acknowledged before it is durable, and what cannot be made durable did not happen.
#include <gtest/gtest.h>

#include "coordinator/core/testing/core_fixture.h"

namespace cairn::coordinator {
namespace {

// "me: ok" or "me: why not", of the last event.
std::vector<std::string> Answers(const CoreFixture& fixture) {
  std::vector<std::string> told;
  for (const Answer& answer : fixture.All<Answer>())
    told.push_back(answer.asker + ": " + (answer.refusal.empty() ? "ok" : answer.refusal));
  return told;
}

using Lines = std::vector<std::string>;

TEST(CoreDurable, ASubmissionIsAnsweredWhenItIsSavedNotBefore) {
  CoreFixture fixture;
  fixture.Do(SubmitJob{"a", TestJob(), {}, "me"});
  EXPECT_EQ(Answers(fixture), Lines{});
  fixture.Do(SubmitJob{"a", TestJob(), {}, "you"});
  EXPECT_EQ(Answers(fixture), Lines{}) << "told twice: it is no more durable than before";
  fixture.Do(PersistDone{"a", 1});
  EXPECT_EQ(Answers(fixture), (Lines{"me: ok", "you: ok"}));
  fixture.Do(SubmitJob{"a", TestJob(), {}, "she"});
  EXPECT_EQ(Answers(fixture), Lines{"she: ok"});
}

TEST(CoreDurable, ASubmissionThatCannotBeSavedIsRefusedAndTheJobIsGone) {
  CoreFixture fixture;
  fixture.Join("w");
  fixture.Do(SubmitJob{"a", TestJob(), {H(1000)}, "me"});
  fixture.Next();  // its start is with a worker already
  fixture.Do(SubmitJob{"a", TestJob(), {}, "you"});
  fixture.Do(PauseJob{"a", "she"});
  fixture.Do(PersistFailed{"a", 1, "no space"});
  const std::string refusal = ": cannot save: no space; the job was not taken";
  EXPECT_EQ(Answers(fixture), (Lines{"me" + refusal, "you" + refusal, "she" + refusal}));
  EXPECT_EQ(fixture.core.FindJob("a"), nullptr);
  EXPECT_EQ(fixture.Sent(&wire::Envelope::has_cancel).size(), 1u);
  EXPECT_EQ(fixture.All<ForgetJob>().size(), 1u);
  EXPECT_EQ(fixture.core.held_blobs(), 0u);
  fixture.Do(ForgetDone{"a"});
  EXPECT_FALSE(fixture.core.HasUnsaved());
  fixture.Do(SubmitJob{"a", TestJob(), {}, "me"});
  fixture.Do(PersistDone{"a", 1});
  EXPECT_EQ(Answers(fixture), Lines{"me: ok"}) << "once there is room";
}

TEST(CoreDurable, ACommandIsAnsweredByTheCheckpointThatHoldsItNotByTheOneUnderWay) {
  CoreFixture fixture;
  Begin(fixture, 2);
  fixture.Advance(1.1);
  ASSERT_EQ(fixture.All<Persist>().size(), 1u);
  fixture.Do(PrioritizeJob{"a", 3, "me"});
  fixture.Do(PersistDone{"a", 2});
  EXPECT_EQ(Answers(fixture), Lines{});
  ASSERT_EQ(fixture.All<Persist>().size(), 1u);
  EXPECT_EQ(fixture.All<Persist>()[0].checkpoint.job().priority(), 3);
  fixture.Do(PersistDone{"a", 3});
  EXPECT_EQ(Answers(fixture), Lines{"me: ok"});
}

const Lines kTakenBack = {"me: cannot save: no space; a is as it was before"};

TEST(CoreDurable, APauseThatCannotBeSavedIsTakenBack) {
  CoreFixture fixture;
  Begin(fixture, 2);
  fixture.Do(PauseJob{"a", "me"});
  fixture.Do(PersistFailed{"a", 2, "no space"});
  EXPECT_EQ(Answers(fixture), kTakenBack);
  EXPECT_FALSE(fixture.core.FindJob("a")->held);
  EXPECT_EQ(fixture.Info().reason(), "cannot save: no space") << "for the disk, and over at the next start";
}

TEST(CoreDurable, ACancelThatCannotBeSavedIsTakenBackAndTheJobCanGoOn) {
  CoreFixture fixture;
  Begin(fixture, 2, 2);
  fixture.AnswerRun(fixture.Next(), H(10));
  fixture.Next();
  fixture.Do(CancelJob{"a", "me"});
  EXPECT_EQ(fixture.Info().state(), "cancelled");
  fixture.Do(PersistFailed{"a", 2, "no space"});
  EXPECT_EQ(Answers(fixture), kTakenBack);
  EXPECT_EQ(fixture.Info().state(), "paused");
  fixture.Do(ResumeJob{"a", "me"});
  fixture.Do(PersistDone{"a", 3});
  EXPECT_EQ(Answers(fixture), Lines{"me: ok"});
  const auto task = fixture.Next();
  EXPECT_EQ(task.assign.key().task(), 1u) << "what was done is not done again";
  fixture.AnswerRun(task, H(11));
  EXPECT_EQ(fixture.Next().assign.partials(0), H(10).Binary());
}

TEST(CoreDurable, AResumeThatCannotBeSavedLeavesTheJobPausedByItsOwner) {
  CoreFixture fixture;
  Begin(fixture, 2);
  fixture.Do(PauseJob{"a", "me"});
  fixture.Do(PersistDone{"a", 2});
  fixture.Do(ResumeJob{"a", "me"});
  EXPECT_EQ(fixture.Info().state(), "running");
  fixture.Do(PersistFailed{"a", 3, "no space"});
  EXPECT_EQ(Answers(fixture), kTakenBack);
  EXPECT_EQ(fixture.Info().reason(), "paused by its owner");
  EXPECT_TRUE(fixture.core.FindJob("a")->held);
}

TEST(CoreDurable, ARetryThatCannotBeSavedLeavesTheJobFailedWithItsReason) {
  CoreFixture fixture;
  Begin(fixture, 1);
  fixture.Fail(fixture.Next(), "no good", true);
  fixture.Do(PersistDone{"a", 2});
  const std::string reason = fixture.Info().reason();
  fixture.Do(RetryJob{"a", "me"});
  fixture.Next();
  fixture.Do(PersistFailed{"a", 3, "no space"});
  EXPECT_EQ(Answers(fixture), kTakenBack);
  EXPECT_EQ(fixture.Info().state(), "failed");
  EXPECT_EQ(fixture.Info().reason(), reason);
  EXPECT_TRUE(fixture.Info().input_error());
  EXPECT_EQ(fixture.Sent(&wire::Envelope::has_cancel).size(), 1u);
  fixture.Do(RetryJob{"a", "me"});
  EXPECT_EQ(fixture.Next().assign.key().kind(), wire::TaskKey::RUN);
}

TEST(CoreDurable, WhatWasAskedMeanwhileIsTakenBackWithIt) {
  CoreFixture fixture;
  Begin(fixture, 2);
  fixture.Do(PrioritizeJob{"a", 3, "me"});
  fixture.Do(CancelJob{"a", "you"});
  fixture.Do(CancelJob{"a", "she"});
  fixture.Do(PersistFailed{"a", 2, "no space"});
  EXPECT_EQ(Answers(fixture).size(), 3u);
  EXPECT_EQ(fixture.Info().priority(), 0);
  EXPECT_EQ(fixture.Info().state(), "paused");
}

TEST(CoreDurable, AJobThatFailsMeanwhileStaysFailed) {
  CoreFixture fixture;
  Begin(fixture, 2);
  const auto task = fixture.Next();
  fixture.Do(PauseJob{"a", "me"});
  fixture.Fail(task, "no good", true);
  fixture.Do(PersistFailed{"a", 2, "no space"});
  EXPECT_EQ(Answers(fixture), kTakenBack);
  EXPECT_EQ(fixture.Info().state(), "failed");
}

// As a priority of a job that stands still because the disk is full.
TEST(CoreDurable, ACommandToAJobThatWaitsForTheDiskIsTriedNotJustAcknowledged) {
  CoreFixture fixture;
  Begin(fixture, 2);
  fixture.Advance(1.1);
  fixture.Do(PersistFailed{"a", 2, "no space"});
  fixture.Do(PrioritizeJob{"a", 3, "me"});
  EXPECT_EQ(Answers(fixture), Lines{});
  ASSERT_EQ(fixture.All<Persist>().size(), 1u);
  fixture.Do(PersistFailed{"a", 3, "no space"});
  EXPECT_EQ(Answers(fixture), kTakenBack);
  EXPECT_EQ(fixture.Info().priority(), 0);
  fixture.Advance(9);
  EXPECT_TRUE(fixture.All<Persist>().empty()) << "it waits again";
}

TEST(CoreDurable, AJobThatIsDoneButForItsEndIsDoneAfterARestartThoughItWasSavedAsPaused) {
  CoreFixture before;
  before.Submit();
  before.Do(PersistDone{"a", 1});
  before.Join("w");
  before.AnswerResult(before.Next(), H(20));
  before.Do(PersistFailed{"a", 2, "no space"});
  before.Do(PrioritizeJob{"a", 3, "me"});
  ASSERT_EQ(before.All<Persist>().size(), 1u);
  const proto::Checkpoint paused = before.All<Persist>()[0].checkpoint;
  EXPECT_EQ(paused.state(), proto::JOB_PAUSED);
  CoreFixture after;
  after.Do(RestoreJob{paused, {}});
  ASSERT_EQ(after.All<Persist>().size(), 1u);
  EXPECT_EQ(after.All<Persist>()[0].checkpoint.state(), proto::JOB_DONE);
  after.Do(PersistDone{"a", 4});
  EXPECT_EQ(after.Info().state(), "done");
}

TEST(CoreDurable, AJobIsDeletedWhenTheDiskHasForgottenIt) {
  CoreFixture fixture;
  Begin(fixture, 1);
  fixture.Fail(fixture.Next(), "no good", true);
  fixture.Do(PersistDone{"a", 2});
  fixture.Do(DeleteJob{"a", "me"});
  fixture.Do(DeleteJob{"a", "you"});
  EXPECT_TRUE(fixture.All<ForgetJob>().empty()) << "it was asked to already";
  fixture.Do(RetryJob{"a", "she"});
  EXPECT_EQ(Answers(fixture), Lines{"she: it is being deleted"});
  fixture.Do(ForgetFailed{"a", "no space"});
  EXPECT_EQ(Answers(fixture), (Lines{"me: cannot delete a: no space", "you: cannot delete a: no space"}));
  EXPECT_EQ(fixture.Info().state(), "failed");
  fixture.Do(DeleteJob{"a", "me"});
  EXPECT_TRUE(fixture.core.HasUnsaved());
  fixture.Do(ForgetDone{"a"});
  EXPECT_EQ(Answers(fixture), Lines{"me: ok"});
  EXPECT_EQ(fixture.core.FindJob("a"), nullptr);
  EXPECT_EQ(fixture.core.held_blobs(), 0u);
}

// Else its end would be written after all that there was of it went.
TEST(CoreDurable, AJobThatIsBeingDeletedIsNotSaved) {
  CoreFixture fixture;
  Begin(fixture, 1);
  fixture.Fail(fixture.Next(), "no good", true);
  fixture.Do(DeleteJob{"a", "me"});
  fixture.Do(PersistFailed{"a", 2, "no space"});
  fixture.Advance(9);
  EXPECT_TRUE(fixture.All<Persist>().empty());
  fixture.Do(ForgetFailed{"a", "no space"});
  fixture.Advance(9);
  EXPECT_EQ(fixture.All<Persist>().size(), 1u);
}

TEST(CoreDurable, ARefusalByTheRulesIsToldAtOnce) {
  CoreFixture fixture;
  Begin(fixture, 1);
  fixture.Do(RetryJob{"a", "me"});
  EXPECT_EQ(Answers(fixture), Lines{"me: it has not failed"});
  fixture.Do(CancelJob{"nobody", "me"});
  EXPECT_EQ(Answers(fixture), Lines{"me: there is no job 'nobody'"});
}

}  // namespace
}  // namespace cairn::coordinator
