// What a job's owner tells it, in every state.
#include <gtest/gtest.h>

#include "coordinator/core/core_bench.h"

namespace cairn::coordinator {
namespace {

using CommandFrom = wire::Envelope;

// The number of the checkpoint that the last event began, which it must have.
std::uint64_t Persisted(const Bench& bench) {
  const auto persists = bench.All<Persist>();
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

TEST(CoreCommands, APausedJobFinishesWhatIsInHandAndGetsNoMoreUntilItIsResumed) {
  Bench bench;
  Begin(bench, 3, 1);
  bench.Do(PauseJob{"a"});
  EXPECT_EQ(bench.Info().state(), "paused");
  EXPECT_EQ(bench.Info().reason(), "paused by its owner");
  EXPECT_TRUE(bench.Sent(&CommandFrom::has_cancel).empty());
  const std::uint64_t number = Persisted(bench);
  bench.AnswerRun(bench.Next(), H(10));
  EXPECT_EQ(bench.Info().tasks_done(), 1u);
  EXPECT_TRUE(bench.assigned.empty());
  bench.Do(PersistDone{"a", number});
  bench.Do(ResumeJob{"a"});
  EXPECT_EQ(bench.Info().state(), "running");
  EXPECT_EQ(bench.Next().assign.key().task(), 1u);
}

TEST(CoreCommands, ARestartLeavesAJobPausedThatItsOwnerPaused) {
  Bench before;
  Begin(before, 2);
  before.Do(PauseJob{"a"});
  ASSERT_EQ(before.All<Persist>().size(), 1u);
  Bench after;
  after.Do(RestoreJob{before.All<Persist>()[0].checkpoint, {}});
  after.Join("w");
  EXPECT_EQ(after.Info().reason(), "paused by its owner");
  EXPECT_TRUE(after.assigned.empty());
  after.Do(ResumeJob{"a"});
  EXPECT_EQ(after.Next().assign.key().kind(), wire::TaskKey::RUN);
}

TEST(CoreCommands, CancelCallsTasksBackAndKeepsTheBlobsUntilItIsDurable) {
  Bench bench;
  Begin(bench, 2, 2);
  bench.AnswerRun(bench.Next(), H(10));
  bench.Do(CancelJob{"a"});
  EXPECT_EQ(bench.Info().state(), "cancelled");
  EXPECT_EQ(bench.Sent(&CommandFrom::has_cancel).size(), 1u);
  const std::uint64_t number = Persisted(bench);
  EXPECT_EQ(bench.All<Persist>()[0].checkpoint.blobs_size(), 0);
  EXPECT_TRUE(bench.core.Holds(H(1000))) << "a crash now finds the checkpoint before, which needs it";
  bench.Do(PersistDone{"a", number});
  EXPECT_EQ(bench.core.held_blobs(), 0u);
  bench.Do(ResumeJob{"a"});
  bench.Do(RetryJob{"a"});
  EXPECT_EQ(bench.Info().state(), "cancelled");
}

TEST(CoreCommands, ACancelThatCannotBeSavedIsSavedAgainAndAgain) {
  Bench bench;
  Begin(bench, 1);
  bench.Do(CancelJob{"a"});
  bench.Do(PersistFailed{"a", Persisted(bench), "no space left"});
  EXPECT_EQ(bench.Info().state(), "cancelled");
  EXPECT_TRUE(bench.core.HasUnsaved());
  bench.Advance(1);
  EXPECT_TRUE(bench.All<Persist>().empty());
  bench.Advance(5);
  EXPECT_EQ(bench.All<Persist>().size(), 1u);
}

TEST(CoreCommands, RetryGoesOnFromTheStepOfAFailedJob) {
  Bench bench;
  Begin(bench, 1);
  for (int i = 0; i < 3; ++i) bench.Fail(bench.Next(), "no good");
  EXPECT_EQ(bench.Info().state(), "failed");
  bench.Do(ResumeJob{"a"});
  EXPECT_EQ(bench.Info().state(), "failed") << "resume is for what waits";
  bench.Do(RetryJob{"a"});
  EXPECT_EQ(bench.Info().state(), "running");
  bench.AnswerRun(bench.Next(), H(10));
  EXPECT_EQ(bench.Next().assign.key().kind(), wire::TaskKey::ADVANCE);
}

TEST(CoreCommands, DeleteTakesAllThatAnEndedJobHasAndNothingOfARunningOne) {
  Bench bench;
  Begin(bench, 1);
  const auto task = bench.Next();
  bench.Do(DeleteJob{"a"});
  EXPECT_EQ(bench.Info().state(), "running");
  bench.Fail(task, "no good", true);
  bench.Do(DeleteJob{"a"});
  ASSERT_EQ(bench.All<ForgetJob>().size(), 1u);
  bench.Do(ForgetDone{"a"});
  EXPECT_EQ(bench.core.FindJob("a"), nullptr);
  EXPECT_EQ(bench.core.held_blobs(), 0u);
  bench.AnswerRun(task, H(10));
  EXPECT_EQ(bench.core.held_blobs(), 0u);
  bench.Do(PersistDone{"a", 2});  // of what was under way
  bench.Submit("a");
  EXPECT_EQ(bench.Info().state(), "queued") << "the name is free again";
}

TEST(CoreCommands, APriorityIsSavedAtOnceAndOutOfRangeItIsNone) {
  Bench bench;
  Begin(bench, 1);
  bench.Do(PrioritizeJob{"a", 11});
  EXPECT_EQ(bench.Info().priority(), 0);
  bench.Do(PrioritizeJob{"a", 4});
  EXPECT_EQ(bench.Info().priority(), 4);
  Persisted(bench);
  EXPECT_EQ(bench.All<Persist>()[0].checkpoint.job().priority(), 4);
  proto::Job job = TestJob();
  const Hash hash = HashOfJob(job);
  job.set_priority(4);
  job.set_task_time_s(60);
  job.set_task_memory_mb(60);
  EXPECT_EQ(HashOfJob(job), hash) << "no bit of a result depends on these";
}

}  // namespace
}  // namespace cairn::coordinator
