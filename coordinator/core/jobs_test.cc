// The life of a job: rounds, stages, chains of tasks, ends, checkpoints.
#include <gtest/gtest.h>

#include <cmath>

#include "coordinator/core/core_bench.h"

namespace cairn::coordinator {
namespace {

using Envelope = wire::Envelope;

TEST(CoreJobs, RunsStartThenTasksThenAdvanceThenTheNextStage) {
  Bench bench;
  bench.Submit("a", TestJob(2));
  bench.Join("w");
  Bench::Assigned start = bench.Next();
  EXPECT_EQ(start.assign.key().kind(), wire::TaskKey::START);
  EXPECT_EQ(start.assign.stage().name(), "stage0");
  EXPECT_EQ(start.assign.seed(), 7u);
  EXPECT_EQ(start.assign.inputs().at("log"), H(1000).Binary());
  proto::Step step = TestStep(2);
  (*step.mutable_state()->mutable_blobs())["map"] = H(5).Binary();
  bench.AnswerPlan(start, step, {H(5)});
  bench.AnswerRun(bench.Next(), H(10));
  bench.AnswerRun(bench.Next(), H(11));
  const Bench::Assigned advance = bench.Next();
  EXPECT_EQ(advance.assign.key().kind(), wire::TaskKey::ADVANCE);
  EXPECT_EQ(advance.assign.key().round(), 0u);
  ASSERT_EQ(advance.assign.partials_size(), 2);
  EXPECT_EQ(advance.assign.partials(0), H(10).Binary());
  EXPECT_EQ(advance.assign.partials(1), H(11).Binary());
  EXPECT_EQ(advance.assign.state().blobs().at("map"), H(5).Binary());
  EXPECT_EQ(advance.assign.inputs().at("log"), H(1000).Binary());
  bench.AnswerResult(advance, H(20));
  const Bench::Assigned second = bench.Next();
  EXPECT_EQ(second.assign.key().kind(), wire::TaskKey::START);
  EXPECT_EQ(second.assign.key().stage(), 1u);
  EXPECT_EQ(second.assign.inputs().at("before"), H(20).Binary());
}

TEST(CoreJobs, PartialsAreReducedInTaskOrderWhateverTheOrderOfAnswers) {
  Bench bench;
  Begin(bench, 3, 4);
  const auto t0 = bench.Next(), t1 = bench.Next(), t2 = bench.Next();
  bench.AnswerRun(t2, H(12));
  bench.AnswerRun(t0, H(10));
  bench.AnswerRun(t1, H(11));
  const auto advance = bench.Next();
  ASSERT_EQ(advance.assign.partials_size(), 3);
  for (int i = 0; i < 3; ++i)
    EXPECT_EQ(advance.assign.partials(i), H(10 + static_cast<std::uint64_t>(i)).Binary());
}

TEST(CoreJobs, ATaskIsSentWithTheHashOfThePartialThatItNames) {
  Bench bench;
  bench.Submit();
  bench.Join("w", 4);
  proto::Step step = TestStep(2);
  step.mutable_tasks(1)->mutable_inputs(0)->set_task(0);
  bench.AnswerPlan(bench.Next(), step);
  const auto first = bench.Next();
  EXPECT_TRUE(bench.assigned.empty());
  bench.AnswerRun(first, H(10));
  const auto second = bench.Next();
  EXPECT_EQ(second.assign.key().task(), 1u);
  ASSERT_TRUE(second.assign.task().inputs(0).source_case() == proto::InputRef::kBlob);
  EXPECT_EQ(second.assign.task().inputs(0).blob(), H(10).Binary());
}

TEST(CoreJobs, ARoundWithoutTasksIsReducedAtOnce) {
  Bench bench;
  Begin(bench, 0);
  EXPECT_EQ(bench.Next().assign.key().kind(), wire::TaskKey::ADVANCE);
}

TEST(CoreJobs, IsDoneOnlyWhenItsEndIsDurable) {
  Bench bench;
  Begin(bench, 0);
  bench.AnswerResult(bench.Next(), H(20));
  const auto persists = bench.All<Persist>();
  ASSERT_EQ(persists.size(), 1u);
  EXPECT_EQ(persists[0].checkpoint.state(), proto::JOB_DONE);
  ASSERT_EQ(persists[0].publish.size(), 1u);
  EXPECT_EQ(persists[0].publish[0].result, H(20));
  EXPECT_EQ(bench.Info().state(), "running");
  EXPECT_TRUE(bench.core.Holds(H(20)));
  bench.Do(PersistDone{"a", persists[0].checkpoint.number()});
  EXPECT_EQ(bench.Info().state(), "done");
  EXPECT_EQ(bench.core.held_blobs(), 0u);
}

TEST(CoreJobs, AnInputErrorFailsTheJobAtOnce) {
  Bench bench;
  Begin(bench, 2, 2);
  const auto task = bench.Next();
  bench.Fail(task, "robot 2, step 5: no mass left", true);
  EXPECT_EQ(bench.Info().state(), "failed");
  EXPECT_TRUE(bench.Info().input_error());
  EXPECT_EQ(bench.Info().reason(),
            "task 0 (toy) of round 0 of stage 'stage0': robot 2, step 5: no mass left");
  EXPECT_EQ(bench.Sent(&Envelope::has_cancel).size(), 1u) << "the other task is called back";
  ASSERT_EQ(bench.All<Persist>().size(), 1u);
  EXPECT_EQ(bench.All<Persist>()[0].checkpoint.state(), proto::JOB_FAILED);
}

TEST(CoreJobs, ATaskThatFailsThreeTimesFailsTheJobAndOthersLiveOn) {
  Bench bench;
  Begin(bench, 1);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(bench.Info().state(), "running");
    bench.Fail(bench.Next(), "bad_alloc");
  }
  EXPECT_EQ(bench.Info().state(), "failed");
  EXPECT_FALSE(bench.Info().input_error());
  EXPECT_NE(
      bench.Info().reason().find("task 0 (toy) of round 0 of stage 'stage0' failed 3 times, last: bad_alloc"),
      std::string::npos);
  bench.Submit("b");
  EXPECT_EQ(bench.Next().assign.key().job(), "b");
}

TEST(CoreJobs, ABadChainOfStagesIsAnInputError) {
  const auto reason = [](auto&& change) {
    Bench bench;
    proto::Job job = TestJob(2);
    change(job);
    bench.Submit("a", job);
    EXPECT_EQ(bench.Info().state(), "failed");
    EXPECT_TRUE(bench.Info().input_error());
    return bench.Info().reason();
  };
  EXPECT_EQ(reason([](proto::Job& job) { job.clear_stages(); }), "the job has no stages");
  EXPECT_NE(reason([](proto::Job& job) {
              (*job.mutable_stages(0)->mutable_inputs())["x"] = "stage1";
            }).find("stage1"),
            std::string::npos);
  EXPECT_NE(reason([](proto::Job& job) { job.mutable_stages(1)->set_name("log"); }).find("'log'"),
            std::string::npos);
  for (const std::string name : {"", "../up", ".hidden", "a b"})
    EXPECT_NE(reason([&](proto::Job& job) { job.mutable_stages(1)->set_name(name); }).find("cannot be"),
              std::string::npos);
  EXPECT_NE(reason([](proto::Job& job) { (*job.mutable_input_blobs())["log"] = "x"; }).find("hash"),
            std::string::npos);
}

TEST(CoreJobs, APlanThatNamesABlobNobodyHasIsAFailureOfTheTask) {
  Bench bench;
  bench.Submit();
  bench.Join("w");
  proto::Step step = TestStep(1);
  step.mutable_tasks(0)->mutable_inputs(0)->set_blob(H(77).Binary());
  for (int i = 0; i < 3; ++i) bench.AnswerPlan(bench.Next(), step);
  EXPECT_EQ(bench.Info().state(), "failed");
  EXPECT_NE(bench.Info().reason().find(H(77).Hex()), std::string::npos);
}

// How many tasks of jobs "a" and "b", a second each, are served while neither ends.
std::map<std::string, int> Share(Bench& bench, int tasks) {
  bench.Submit("a");
  bench.Submit("b");
  bench.Join("w", 2);
  bench.now_s += 1;
  const auto a = bench.Next(), b = bench.Next();
  EXPECT_EQ(a.assign.key().job(), "a");
  EXPECT_EQ(b.assign.key().job(), "b");
  bench.AnswerPlan(a, TestStep(1000));
  bench.AnswerPlan(b, TestStep(1000));
  std::map<std::string, int> served;
  for (int i = 0; i < tasks; ++i) {
    const auto task = bench.Next();
    ++served[task.assign.key().job()];
    bench.now_s += 1;
    bench.AnswerRun(task, H(static_cast<std::uint64_t>(i)));
  }
  return served;
}

TEST(CoreJobs, JobsOfEqualPriorityShareTheWorkers) {
  Bench bench;
  const auto served = Share(bench, 200);
  EXPECT_NEAR(served.at("a"), 100, 3);
}

TEST(CoreJobs, AHigherPriorityGetsTwiceAsMuchAndNobodyStarves) {
  Bench bench;
  bench.Do(Tick{});
  proto::Job job = TestJob();
  job.set_priority(1);
  bench.Submit("b", job);
  bench.Do(PersistDone{"b", 1});
  bench.Submit("a");
  bench.Join("w", 2);
  bench.now_s += 1;
  for (int i = 0; i < 2; ++i) bench.AnswerPlan(bench.Next(), TestStep(1000));
  std::map<std::string, int> served;
  for (int i = 0; i < 300; ++i) {
    const auto task = bench.Next();
    ++served[task.assign.key().job()];
    bench.now_s += 1;
    bench.AnswerRun(task, H(static_cast<std::uint64_t>(i)));
  }
  EXPECT_NEAR(served.at("b"), 200, 6);
}

TEST(CoreJobs, TwoAnswersThatDifferRaiseAnAlarmAndFailTheJob) {
  Bench bench;
  Begin(bench, 2, 2);
  const auto task = bench.Next();
  bench.AnswerRun(task, H(10));
  bench.AnswerRun(task, H(10));
  EXPECT_TRUE(bench.alarms.empty());
  bench.AnswerRun(task, H(11));
  ASSERT_EQ(bench.alarms.size(), 1u);
  EXPECT_NE(bench.alarms[0].find(H(11).Hex()), std::string::npos);
  EXPECT_EQ(bench.Info().state(), "failed");
}

TEST(CoreJobs, TwoPlansThatDifferRaiseAnAlarmEvenAfterTheRoundHasBegun) {
  Bench bench;
  bench.Submit();
  bench.Join("w");
  const auto start = bench.Next();
  bench.AnswerPlan(start, TestStep(1, "one"));
  bench.AnswerPlan(start, TestStep(1, "one"));
  EXPECT_TRUE(bench.alarms.empty());
  bench.AnswerPlan(start, TestStep(1, "two"));
  EXPECT_EQ(bench.alarms.size(), 1u);
}

TEST(CoreJobs, AnswersOfAnEarlierRoundAreIgnoredAndTheirBlobsDropped) {
  Bench bench;
  Begin(bench, 1);
  const auto old_task = bench.Next();
  bench.AnswerRun(old_task, H(10));
  bench.AnswerPlan(bench.Next(), TestStep(1));
  EXPECT_EQ(bench.Info().round(), 1u);
  bench.AnswerRun(old_task, H(99));
  EXPECT_EQ(bench.Info().tasks_done(), 0u);
  ASSERT_EQ(bench.All<DropBlobs>().size(), 1u);
  EXPECT_EQ(bench.All<DropBlobs>()[0].hashes, std::vector<Hash>{H(99)});
}

TEST(CoreJobs, APlanThatIsNoPlanIsAFailureOfTheTask) {
  Bench bench;
  bench.Submit();
  bench.Join("w");
  const auto start = bench.Next();
  wire::Done done;
  *done.mutable_key() = start.assign.key();
  bench.Do(TaskDone{"w", done, {}});
  EXPECT_EQ(bench.core.FindJob("a")->failures.size(), 1u);
  EXPECT_EQ(bench.Next().assign.key().kind(), wire::TaskKey::START);
}

TEST(CoreJobs, TimesThatCannotBeAreNotCounted) {
  Bench bench;
  bench.Submit();
  bench.Join("w");
  bench.AnswerPlan(bench.Next(), TestStep(2));
  for (const double seconds : {std::nan(""), -1e300}) {
    const auto task = bench.Next();
    wire::Done done;
    *done.mutable_key() = task.assign.key();
    done.set_partial(H(10).Binary());
    done.set_seconds(seconds);
    bench.Do(TaskDone{"w", done, {H(10)}});
  }
  EXPECT_EQ(bench.core.FindJob("a")->facts.back().open_compute_seconds(), 0);
}

TEST(CoreJobs, AnAnswerWithoutItsBlobIsAFailure) {
  Bench bench;
  Begin(bench, 1);
  const auto task = bench.Next();
  wire::Done done;
  *done.mutable_key() = task.assign.key();
  done.set_partial(H(10).Binary());
  bench.Do(TaskDone{task.peer, done, {}});
  EXPECT_EQ(bench.Info().tasks_done(), 0u);
  EXPECT_EQ(bench.Next().assign.key().attempt(), 2u);
}

TEST(CoreJobs, InfoSaysWhereAJobStands) {
  Bench bench;
  bench.Submit();
  EXPECT_EQ(bench.Info().state(), "queued");
  bench.Join("w", 2);
  bench.AnswerPlan(bench.Next(), TestStep(2, "iteration 1"));
  bench.AnswerRun(bench.Next(), H(10));
  const wire::JobInfo info = bench.Info();
  EXPECT_EQ(info.state(), "running");
  EXPECT_EQ(info.stages(), 1u);
  EXPECT_EQ(info.tasks(), 2u);
  EXPECT_EQ(info.tasks_done(), 1u);
  EXPECT_EQ(info.note(), "iteration 1");
}

constexpr double kDay_s = 86400;

CoreOptions KeepFor(double days) {
  CoreOptions options;
  options.keep_s = days * kDay_s;
  return options;
}

TEST(CoreJobs, AJobThatHasEndedForLongerThanItIsKeptGoesAsIfDeleted) {
  Bench bench(KeepFor(2));
  bench.Submit("a");
  bench.Do(PersistDone{"a", 1});
  bench.Submit("b");
  bench.Do(PersistDone{"b", 1});
  bench.Do(CancelJob{"a"});
  bench.Do(PersistDone{"a", 2});
  bench.Advance(2 * kDay_s);
  EXPECT_EQ(bench.Info("a").state(), "cancelled") << "not for longer yet";
  bench.Advance(1);
  ASSERT_EQ(bench.All<ForgetJob>().size(), 1u);
  EXPECT_EQ(bench.All<ForgetJob>()[0].job, "a");
  EXPECT_EQ(bench.All<Report>().size(), 1u) << "it is told";
  bench.Advance(1);
  EXPECT_TRUE(bench.All<ForgetJob>().empty()) << "once";
  bench.Do(ForgetFailed{"a", "no space"});
  bench.Advance(1);
  EXPECT_TRUE(bench.All<ForgetJob>().empty());
  bench.Advance(5);
  EXPECT_EQ(bench.All<ForgetJob>().size(), 1u) << "it is tried again by and by";
  bench.Do(ForgetDone{"a"});
  EXPECT_EQ(bench.core.FindJob("a"), nullptr);
  bench.Advance(100 * kDay_s);
  EXPECT_EQ(bench.Info("b").state(), "queued") << "what has not ended does not grow old";
}

TEST(CoreJobs, AnEndThatIsNotDurableIsKept) {
  Bench bench(KeepFor(1));
  bench.Submit("a");
  bench.Do(PersistDone{"a", 1});
  bench.Do(CancelJob{"a"});
  bench.Advance(3 * kDay_s);
  EXPECT_TRUE(bench.All<ForgetJob>().empty());
  bench.Do(PersistDone{"a", 2});
  bench.Advance(1);
  EXPECT_EQ(bench.All<ForgetJob>().size(), 1u);
}

TEST(CoreJobs, ByDefaultJobsAreKeptForEver) {
  Bench bench;
  bench.Submit("a");
  bench.Do(PersistDone{"a", 1});
  bench.Do(CancelJob{"a"});
  bench.Do(PersistDone{"a", 2});
  bench.Advance(1e5 * kDay_s);
  EXPECT_EQ(bench.Info("a").state(), "cancelled");
}

TEST(CoreJobs, ARestartNeitherResetsAJobsAgeNorAddsToIt) {
  Bench before(KeepFor(2));
  before.Do(Served{10 * kDay_s});
  before.Submit("a");
  before.Do(PersistDone{"a", 1});
  before.Advance(kDay_s);
  before.Do(CancelJob{"a"});
  const proto::Checkpoint end = before.All<Persist>().at(0).checkpoint;
  EXPECT_EQ(end.ended_served_s(), 11 * kDay_s);
  before.Do(PersistDone{"a", 2});
  before.Advance(1.5 * kDay_s);
  EXPECT_EQ(before.core.served_s(), 12.5 * kDay_s);

  Bench after(KeepFor(2));
  after.now_s = 1e6 * kDay_s;  // another machine's clock, ages later
  after.Do(Served{before.core.served_s()});
  after.Do(RestoreJob{end, {}});
  after.Advance(0.4 * kDay_s);
  EXPECT_EQ(after.Info("a").state(), "cancelled") << "1.9 days";
  after.Advance(0.2 * kDay_s);
  EXPECT_EQ(after.All<ForgetJob>().size(), 1u) << "2.1 days";
}

TEST(CoreJobs, WhereTheTimeServedWasLostNoJobIsOlderThanItWas) {
  Bench bench(KeepFor(2));
  proto::Checkpoint end;
  end.set_job_id("a");
  end.set_number(2);
  end.set_order(1);
  *end.mutable_job() = TestJob();
  end.set_state(proto::JOB_CANCELLED);
  end.set_ended_served_s(30 * kDay_s);
  bench.Do(Served{0});
  bench.Do(RestoreJob{end, {}});
  EXPECT_EQ(bench.core.served_s(), 30 * kDay_s);
  bench.Advance(1.9 * kDay_s);
  EXPECT_EQ(bench.Info("a").state(), "cancelled");
  bench.Advance(0.2 * kDay_s);
  EXPECT_EQ(bench.All<ForgetJob>().size(), 1u);
}

TEST(CoreJobs, AFailedJobThatIsRetriedIsYoungAgain) {
  Bench bench(KeepFor(2));
  bench.Join("w");
  bench.Submit("a");
  bench.Do(PersistDone{"a", 1});
  bench.Fail(bench.Next(), "bad", true);
  bench.Do(PersistDone{"a", 2});
  bench.Beat("w");
  bench.Do(RetryJob{"a"});
  bench.Do(PersistDone{"a", 3});
  bench.Beat("w", {bench.Next()}, 1);
  bench.Do(PauseJob{"a"});
  bench.Do(PersistDone{"a", 4});
  bench.Advance(3 * kDay_s);
  EXPECT_EQ(bench.Info("a").state(), "paused") << bench.Info("a").reason();
}

}  // namespace
}  // namespace cairn::coordinator
