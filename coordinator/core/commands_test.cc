// What a job's owner tells it, in every state.
#include <gtest/gtest.h>

#include "coordinator/core/testing/core_fixture.h"

namespace cairn::coordinator {
namespace {

using CommandFrom = wire::Envelope;

// The number of the checkpoint that the last event began, which it must have.
std::uint64_t Persisted(const CoreFixture& fixture) {
  const auto persists = fixture.All<Persist>();
  EXPECT_EQ(persists.size(), 1u);
  return persists.empty() ? 0 : persists[0].checkpoint.number();
}

TEST(CoreCommands, EveryStateObeysWhatTheTableInTheReadmeSays) {
  Job job;
  job.spec = TestJob();
  const auto obeyed = [&job](proto::JobState state) {
    job.state = state;
    std::string commands;
    for (const auto& [name, command] :
         {std::pair{'p', JobCommand::kPause}, std::pair{'r', JobCommand::kResume},
          std::pair{'c', JobCommand::kCancel}, std::pair{'t', JobCommand::kRetry},
          std::pair{'d', JobCommand::kDelete}, std::pair{'n', JobCommand::kPrioritize}})
      if (WhyNot(job, command).empty()) commands += name;
    return commands;
  };
  EXPECT_EQ(obeyed(proto::JOB_RUNNING), "prcn");
  EXPECT_EQ(obeyed(proto::JOB_PAUSED), "prcn");
  EXPECT_EQ(obeyed(proto::JOB_FAILED), "ctdn");
  EXPECT_EQ(obeyed(proto::JOB_CANCELLED), "cd");
  EXPECT_EQ(obeyed(proto::JOB_DONE), "d");
  EXPECT_EQ(WhyNot(job, JobCommand::kRetry), "it is done and its checkpoints are gone; submit it again");
}

TEST(CoreCommands, APausedJobFinishesWhatIsAssignedAndGetsNoMoreUntilItIsResumed) {
  CoreFixture fixture;
  Begin(fixture, 3, 1);
  fixture.Do(PauseJob{"a"});
  EXPECT_EQ(fixture.Info().state(), "paused");
  EXPECT_EQ(fixture.Info().reason(), "paused by its owner");
  EXPECT_TRUE(fixture.Sent(&CommandFrom::has_cancel).empty());
  const std::uint64_t number = Persisted(fixture);
  fixture.AnswerRun(fixture.Next(), H(10));
  EXPECT_EQ(fixture.Info().tasks_done(), 1u);
  EXPECT_TRUE(fixture.assigned.empty());
  fixture.Do(PersistDone{"a", number});
  fixture.Do(ResumeJob{"a"});
  EXPECT_EQ(fixture.Info().state(), "running");
  EXPECT_EQ(fixture.Next().assign.key().task(), 1u);
}

TEST(CoreCommands, ARestartLeavesAJobPausedThatItsOwnerPaused) {
  CoreFixture before;
  Begin(before, 2);
  before.Do(PauseJob{"a"});
  ASSERT_EQ(before.All<Persist>().size(), 1u);
  CoreFixture after;
  after.Do(RestoreJob{before.All<Persist>()[0].checkpoint, {}});
  after.Join("w");
  EXPECT_EQ(after.Info().reason(), "paused by its owner");
  EXPECT_TRUE(after.assigned.empty());
  after.Do(ResumeJob{"a"});
  EXPECT_EQ(after.Next().assign.key().kind(), wire::TaskKey::RUN);
}

TEST(CoreCommands, CancelCallsTasksBackAndKeepsTheBlobsUntilItIsDurable) {
  CoreFixture fixture;
  Begin(fixture, 2, 2);
  fixture.AnswerRun(fixture.Next(), H(10));
  fixture.Do(CancelJob{"a"});
  EXPECT_EQ(fixture.Info().state(), "cancelled");
  EXPECT_EQ(fixture.Sent(&CommandFrom::has_cancel).size(), 1u);
  const std::uint64_t number = Persisted(fixture);
  EXPECT_EQ(fixture.All<Persist>()[0].checkpoint.blobs_size(), 0);
  EXPECT_TRUE(fixture.core.Holds(H(1000))) << "a crash now finds the checkpoint before, which needs it";
  fixture.Do(PersistDone{"a", number});
  EXPECT_EQ(fixture.core.held_blobs(), 0u);
  fixture.Do(ResumeJob{"a"});
  fixture.Do(RetryJob{"a"});
  EXPECT_EQ(fixture.Info().state(), "cancelled");
}

TEST(CoreCommands, ACancelThatCannotBeSavedIsSavedAgainAndAgain) {
  CoreFixture fixture;
  Begin(fixture, 1);
  fixture.Do(CancelJob{"a"});
  fixture.Do(PersistFailed{"a", Persisted(fixture), "no space left"});
  EXPECT_EQ(fixture.Info().state(), "cancelled");
  EXPECT_TRUE(fixture.core.HasUnsaved());
  fixture.Advance(1);
  EXPECT_TRUE(fixture.All<Persist>().empty());
  fixture.Advance(5);
  EXPECT_EQ(fixture.All<Persist>().size(), 1u);
}

TEST(CoreCommands, RetryGoesOnFromTheStepOfAFailedJob) {
  CoreFixture fixture;
  Begin(fixture, 1);
  for (int i = 0; i < 3; ++i) fixture.Fail(fixture.Next(), "no good");
  EXPECT_EQ(fixture.Info().state(), "failed");
  fixture.Do(ResumeJob{"a"});
  EXPECT_EQ(fixture.Info().state(), "failed") << "resume is for what waits";
  fixture.Do(RetryJob{"a"});
  EXPECT_EQ(fixture.Info().state(), "running");
  fixture.AnswerRun(fixture.Next(), H(10));
  EXPECT_EQ(fixture.Next().assign.key().kind(), wire::TaskKey::ADVANCE);
}

TEST(CoreCommands, DeleteTakesAllThatAnEndedJobHasAndNothingOfARunningOne) {
  CoreFixture fixture;
  Begin(fixture, 1);
  const auto task = fixture.Next();
  fixture.Do(DeleteJob{"a"});
  EXPECT_EQ(fixture.Info().state(), "running");
  fixture.Fail(task, "no good", true);
  fixture.Do(DeleteJob{"a"});
  ASSERT_EQ(fixture.All<ForgetJob>().size(), 1u);
  fixture.Do(ForgetDone{"a"});
  EXPECT_EQ(fixture.core.FindJob("a"), nullptr);
  EXPECT_EQ(fixture.core.held_blobs(), 0u);
  fixture.AnswerRun(task, H(10));
  EXPECT_EQ(fixture.core.held_blobs(), 0u);
  fixture.Do(PersistDone{"a", 2});  // of what was under way
  fixture.Submit("a");
  EXPECT_EQ(fixture.Info().state(), "queued") << "the name is free again";
}

TEST(CoreCommands, APriorityIsSavedAtOnceAndOutOfRangeItIsNone) {
  CoreFixture fixture;
  Begin(fixture, 1);
  fixture.Do(PrioritizeJob{"a", 11});
  EXPECT_EQ(fixture.Info().priority(), 0);
  fixture.Do(PrioritizeJob{"a", 4});
  EXPECT_EQ(fixture.Info().priority(), 4);
  Persisted(fixture);
  EXPECT_EQ(fixture.All<Persist>()[0].checkpoint.job().priority(), 4);
  proto::Job job = TestJob();
  const Hash hash = HashOfJob(job);
  job.set_priority(4);
  job.set_task_time_s(60);
  job.set_task_memory_mb(60);
  EXPECT_EQ(HashOfJob(job), hash) << "no bit of a result depends on these";
}

}  // namespace
}  // namespace cairn::coordinator
