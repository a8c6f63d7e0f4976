// The life of a job: rounds, stages, chains of tasks, ends, checkpoints.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "coordinator/core/testing/core_fixture.h"

namespace cairn::coordinator {
namespace {

using Envelope = wire::Envelope;

TEST(CoreJobs, RunsStartThenTasksThenAdvanceThenTheNextStage) {
  CoreFixture fixture;
  fixture.Submit("a", TestJob(2));
  fixture.Join("w");
  CoreFixture::Assigned start = fixture.Next();
  EXPECT_EQ(start.assign.key().kind(), wire::TaskKey::START);
  EXPECT_EQ(start.assign.stage().name(), "stage0");
  EXPECT_EQ(start.assign.seed(), 7u);
  EXPECT_EQ(start.assign.inputs().at("log"), H(1000).Binary());
  proto::Step step = TestStep(2);
  (*step.mutable_state()->mutable_blobs())["map"] = H(5).Binary();
  fixture.AnswerPlan(start, step, {H(5)});
  fixture.AnswerRun(fixture.Next(), H(10));
  fixture.AnswerRun(fixture.Next(), H(11));
  const CoreFixture::Assigned advance = fixture.Next();
  EXPECT_EQ(advance.assign.key().kind(), wire::TaskKey::ADVANCE);
  EXPECT_EQ(advance.assign.key().round(), 0u);
  ASSERT_EQ(advance.assign.partials_size(), 2);
  EXPECT_EQ(advance.assign.partials(0), H(10).Binary());
  EXPECT_EQ(advance.assign.partials(1), H(11).Binary());
  EXPECT_EQ(advance.assign.state().blobs().at("map"), H(5).Binary());
  EXPECT_EQ(advance.assign.inputs().at("log"), H(1000).Binary());
  fixture.AnswerResult(advance, H(20));
  const CoreFixture::Assigned second = fixture.Next();
  EXPECT_EQ(second.assign.key().kind(), wire::TaskKey::START);
  EXPECT_EQ(second.assign.key().stage(), 1u);
  EXPECT_EQ(second.assign.inputs().at("before"), H(20).Binary());
}

TEST(CoreJobs, ThoseThatRunSayHowManyWorkersTheyCouldUse) {
  CoreFixture fixture;
  fixture.Submit();
  ASSERT_EQ(fixture.core.Demand().size(), 1U) << "it waits for its first worker";
  EXPECT_EQ(fixture.core.Demand()[0].tasks(), 1U);
  EXPECT_GT(fixture.core.Demand()[0].work_s(), 0);
  fixture.Do(PersistDone{"a", 1});
  fixture.Join("w");
  fixture.AnswerPlan(fixture.Next(), TestStep(5));
  EXPECT_EQ(fixture.core.Demand()[0].tasks(), 5U);
  fixture.Do(PauseJob{"a", "u"});
  EXPECT_TRUE(fixture.core.Demand().empty());
}

TEST(CoreJobs, PartialsAreReducedInTaskOrderWhateverTheOrderOfAnswers) {
  CoreFixture fixture;
  Begin(fixture, 3, 4);
  const auto t0 = fixture.Next(), t1 = fixture.Next(), t2 = fixture.Next();
  fixture.AnswerRun(t2, H(12));
  fixture.AnswerRun(t0, H(10));
  fixture.AnswerRun(t1, H(11));
  const auto advance = fixture.Next();
  ASSERT_EQ(advance.assign.partials_size(), 3);
  for (int i = 0; i < 3; ++i)
    EXPECT_EQ(advance.assign.partials(i), H(10 + static_cast<std::uint64_t>(i)).Binary());
}

TEST(CoreJobs, ATaskIsSentWithTheHashOfThePartialThatItNames) {
  CoreFixture fixture;
  fixture.Submit();
  fixture.Join("w", 4);
  proto::Step step = TestStep(2);
  step.mutable_tasks(1)->mutable_inputs(0)->set_task(0);
  fixture.AnswerPlan(fixture.Next(), step);
  const auto first = fixture.Next();
  EXPECT_TRUE(fixture.assigned.empty());
  fixture.AnswerRun(first, H(10));
  const auto second = fixture.Next();
  EXPECT_EQ(second.assign.key().task(), 1u);
  ASSERT_TRUE(second.assign.task().inputs(0).source_case() == proto::InputRef::kBlob);
  EXPECT_EQ(second.assign.task().inputs(0).blob(), H(10).Binary());
}

TEST(CoreJobs, ARoundWithoutTasksIsReducedAtOnce) {
  CoreFixture fixture;
  Begin(fixture, 0);
  EXPECT_EQ(fixture.Next().assign.key().kind(), wire::TaskKey::ADVANCE);
}

TEST(CoreJobs, IsDoneOnlyWhenItsEndIsDurable) {
  CoreFixture fixture;
  Begin(fixture, 0);
  fixture.AnswerResult(fixture.Next(), H(20));
  const auto persists = fixture.All<Persist>();
  ASSERT_EQ(persists.size(), 1u);
  EXPECT_EQ(persists[0].checkpoint.state(), proto::JOB_DONE);
  ASSERT_EQ(persists[0].publish.size(), 1u);
  EXPECT_EQ(persists[0].publish[0].result, H(20));
  EXPECT_EQ(fixture.Info().state(), "running");
  EXPECT_TRUE(fixture.core.Holds(H(20)));
  fixture.Do(PersistDone{"a", persists[0].checkpoint.number()});
  EXPECT_EQ(fixture.Info().state(), "done");
  EXPECT_EQ(fixture.core.held_blobs(), 0u);
}

TEST(CoreJobs, AnInputErrorFailsTheJobAtOnce) {
  CoreFixture fixture;
  Begin(fixture, 2, 2);
  const auto task = fixture.Next();
  fixture.Fail(task, "robot 2, step 5: no mass left", true);
  EXPECT_EQ(fixture.Info().state(), "failed");
  EXPECT_TRUE(fixture.Info().input_error());
  EXPECT_EQ(fixture.Info().reason(),
            "task 0 (toy) of round 0 of stage 'stage0': robot 2, step 5: no mass left");
  EXPECT_EQ(fixture.Sent(&Envelope::has_cancel).size(), 1u) << "the other task is called back";
  ASSERT_EQ(fixture.All<Persist>().size(), 1u);
  EXPECT_EQ(fixture.All<Persist>()[0].checkpoint.state(), proto::JOB_FAILED);
}

TEST(CoreJobs, ATaskThatFailsThreeTimesFailsTheJobAndOthersLiveOn) {
  CoreFixture fixture;
  Begin(fixture, 1);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(fixture.Info().state(), "running");
    fixture.Fail(fixture.Next(), "bad_alloc");
  }
  EXPECT_EQ(fixture.Info().state(), "failed");
  EXPECT_FALSE(fixture.Info().input_error());
  EXPECT_NE(fixture.Info().reason().find(
                "task 0 (toy) of round 0 of stage 'stage0' failed 3 times, last: bad_alloc"),
            std::string::npos);
  fixture.Submit("b");
  EXPECT_EQ(fixture.Next().assign.key().job(), "b");
}

// A machine that is too small for a task is free again at once.
TEST(CoreJobs, WhatFailedAtOneWorkerIsTriedByAnotherThoughTheFirstHasRoom) {
  CoreFixture fixture;
  Begin(fixture, 2);
  fixture.Join("x");
  const auto small = fixture.Next(), other = fixture.Next();
  ASSERT_EQ(small.peer, "w");
  ASSERT_EQ(other.peer, "x");
  fixture.Fail(small, "it takes more than 1 MB");
  EXPECT_TRUE(fixture.assigned.empty()) << "the other one has no room yet";
  fixture.AnswerRun(other, H(10));
  auto again = fixture.Next();
  EXPECT_EQ(again.peer, "x");
  EXPECT_EQ(again.assign.key().task(), small.assign.key().task());
  // Where all have failed it, it is for whoever is there; other jobs' tasks are, all along.
  fixture.Submit("b");
  EXPECT_EQ(fixture.Next().peer, "w");
  fixture.Fail(again, "it takes more than 1 MB");
  again = fixture.Next();
  EXPECT_EQ(again.assign.key().task(), small.assign.key().task());
  fixture.Fail(again, "it takes more than 1 MB");
  EXPECT_EQ(fixture.Info().state(), "failed");
}

TEST(CoreJobs, ABadChainOfStagesIsAnInputError) {
  const auto reason = [](auto&& change) {
    CoreFixture fixture;
    proto::Job job = TestJob(2);
    change(job);
    fixture.Submit("a", job);
    EXPECT_EQ(fixture.Info().state(), "failed");
    EXPECT_TRUE(fixture.Info().input_error());
    return fixture.Info().reason();
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
  CoreFixture fixture;
  fixture.Submit();
  fixture.Join("w");
  proto::Step step = TestStep(1);
  step.mutable_tasks(0)->mutable_inputs(0)->set_blob(H(77).Binary());
  for (int i = 0; i < 3; ++i) fixture.AnswerPlan(fixture.Next(), step);
  EXPECT_EQ(fixture.Info().state(), "failed");
  EXPECT_NE(fixture.Info().reason().find(H(77).Hex()), std::string::npos);
}

// How many tasks of jobs "a" and "b", a second each, are served while neither ends.
std::map<std::string, int> Share(CoreFixture& fixture, int tasks) {
  fixture.Submit("a");
  fixture.Submit("b");
  fixture.Join("w", 2);
  fixture.now_s += 1;
  const auto a = fixture.Next(), b = fixture.Next();
  EXPECT_EQ(a.assign.key().job(), "a");
  EXPECT_EQ(b.assign.key().job(), "b");
  fixture.AnswerPlan(a, TestStep(1000));
  fixture.AnswerPlan(b, TestStep(1000));
  std::map<std::string, int> served;
  for (int i = 0; i < tasks; ++i) {
    const auto task = fixture.Next();
    ++served[task.assign.key().job()];
    fixture.now_s += 1;
    fixture.AnswerRun(task, H(static_cast<std::uint64_t>(i)));
  }
  return served;
}

TEST(CoreJobs, JobsOfEqualPriorityShareTheWorkers) {
  CoreFixture fixture;
  const auto served = Share(fixture, 200);
  EXPECT_NEAR(served.at("a"), 100, 3);
}

TEST(CoreJobs, AHigherPriorityGetsTwiceAsMuchAndNobodyStarves) {
  CoreFixture fixture;
  fixture.Do(Tick{});
  proto::Job job = TestJob();
  job.set_priority(1);
  fixture.Submit("b", job);
  fixture.Do(PersistDone{"b", 1});
  fixture.Submit("a");
  fixture.Join("w", 2);
  fixture.now_s += 1;
  for (int i = 0; i < 2; ++i) fixture.AnswerPlan(fixture.Next(), TestStep(1000));
  std::map<std::string, int> served;
  for (int i = 0; i < 300; ++i) {
    const auto task = fixture.Next();
    ++served[task.assign.key().job()];
    fixture.now_s += 1;
    fixture.AnswerRun(task, H(static_cast<std::uint64_t>(i)));
  }
  EXPECT_NEAR(served.at("b"), 200, 6);
}

TEST(CoreJobs, TwoAnswersThatDifferRaiseAnAlarmAndFailTheJob) {
  CoreFixture fixture;
  Begin(fixture, 2, 2);
  const auto task = fixture.Next();
  fixture.AnswerRun(task, H(10));
  fixture.AnswerRun(task, H(10));
  EXPECT_TRUE(fixture.alarms.empty());
  fixture.AnswerRun(task, H(11));
  ASSERT_EQ(fixture.alarms.size(), 1u);
  EXPECT_NE(fixture.alarms[0].find(H(11).Hex()), std::string::npos);
  EXPECT_EQ(fixture.Info().state(), "failed");
}

TEST(CoreJobs, TwoPlansThatDifferRaiseAnAlarmEvenAfterTheRoundHasBegun) {
  CoreFixture fixture;
  fixture.Submit();
  fixture.Join("w");
  const auto start = fixture.Next();
  fixture.AnswerPlan(start, TestStep(1, "one"));
  fixture.AnswerPlan(start, TestStep(1, "one"));
  EXPECT_TRUE(fixture.alarms.empty());
  fixture.AnswerPlan(start, TestStep(1, "two"));
  EXPECT_EQ(fixture.alarms.size(), 1u);
}

TEST(CoreJobs, AnswersOfAnEarlierRoundAreIgnoredAndTheirBlobsDropped) {
  CoreFixture fixture;
  Begin(fixture, 1);
  const auto old_task = fixture.Next();
  fixture.AnswerRun(old_task, H(10));
  fixture.AnswerPlan(fixture.Next(), TestStep(1));
  EXPECT_EQ(fixture.Info().round(), 1u);
  fixture.AnswerRun(old_task, H(99));
  EXPECT_EQ(fixture.Info().tasks_done(), 0u);
  ASSERT_EQ(fixture.All<DropBlobs>().size(), 1u);
  EXPECT_EQ(fixture.All<DropBlobs>()[0].hashes, std::vector<Hash>{H(99)});
}

TEST(CoreJobs, APlanThatIsNoPlanIsAFailureOfTheTask) {
  CoreFixture fixture;
  fixture.Submit();
  fixture.Join("w");
  const auto start = fixture.Next();
  wire::Done done;
  *done.mutable_key() = start.assign.key();
  fixture.Do(TaskDone{"w", done, {}});
  EXPECT_EQ(fixture.core.FindJob("a")->failures.size(), 1u);
  EXPECT_EQ(fixture.Next().assign.key().kind(), wire::TaskKey::START);
}

TEST(CoreJobs, TimesThatCannotBeAreNotCounted) {
  CoreFixture fixture;
  fixture.Submit();
  fixture.Join("w");
  fixture.AnswerPlan(fixture.Next(), TestStep(5));
  for (const double seconds :
       {std::nan(""), -1e300, 1.7e308, 1.7e308, std::numeric_limits<double>::infinity()}) {
    const auto task = fixture.Next();
    wire::Done done;
    *done.mutable_key() = task.assign.key();
    done.set_partial(H(10).Binary());
    done.set_seconds(seconds);
    fixture.Do(TaskDone{"w", done, {H(10)}});
  }
  EXPECT_EQ(fixture.core.FindJob("a")->facts.back().open_compute_seconds(), 0);
}

TEST(CoreJobs, AnAnswerWithoutItsBlobIsAFailure) {
  CoreFixture fixture;
  Begin(fixture, 1);
  const auto task = fixture.Next();
  wire::Done done;
  *done.mutable_key() = task.assign.key();
  done.set_partial(H(10).Binary());
  fixture.Do(TaskDone{task.peer, done, {}});
  EXPECT_EQ(fixture.Info().tasks_done(), 0u);
  EXPECT_EQ(fixture.Next().assign.key().attempt(), 2u);
}

TEST(CoreJobs, InfoSaysWhereAJobStands) {
  CoreFixture fixture;
  fixture.Submit();
  EXPECT_EQ(fixture.Info().state(), "queued");
  fixture.Join("w", 2);
  fixture.AnswerPlan(fixture.Next(), TestStep(2, "iteration 1"));
  fixture.AnswerRun(fixture.Next(), H(10));
  const wire::JobInfo info = fixture.Info();
  EXPECT_EQ(info.state(), "running");
  EXPECT_EQ(info.stages(), 1u);
  EXPECT_EQ(info.tasks(), 2u);
  EXPECT_EQ(info.tasks_done(), 1u);
  EXPECT_EQ(info.note(), "iteration 1");
}

constexpr double kShort_s =
    100;  // a time to keep jobs that passes a tick a second, as of one that is not paused

CoreOptions KeepFor(double times) {
  CoreOptions options;
  options.keep_s = times * kShort_s;
  return options;
}

TEST(CoreJobs, AJobThatHasEndedForLongerThanItIsKeptGoesAsIfDeleted) {
  CoreFixture fixture(KeepFor(2));
  fixture.Submit("a");
  fixture.Do(PersistDone{"a", 1});
  fixture.Submit("b");
  fixture.Do(PersistDone{"b", 1});
  fixture.Do(CancelJob{"a"});
  fixture.Do(PersistDone{"a", 2});
  fixture.Pass(2 * kShort_s);
  EXPECT_EQ(fixture.Info("a").state(), "cancelled") << "not for longer yet";
  fixture.Advance(1);
  ASSERT_EQ(fixture.All<ForgetJob>().size(), 1u);
  EXPECT_EQ(fixture.All<ForgetJob>()[0].job, "a");
  EXPECT_EQ(fixture.All<Report>().size(), 1u) << "it is told";
  fixture.Advance(1);
  EXPECT_TRUE(fixture.All<ForgetJob>().empty()) << "once";
  fixture.Do(ForgetFailed{"a", "no space"});
  fixture.Advance(1);
  EXPECT_TRUE(fixture.All<ForgetJob>().empty());
  fixture.Advance(5);
  EXPECT_EQ(fixture.All<ForgetJob>().size(), 1u) << "it is tried again by and by";
  fixture.Do(ForgetDone{"a"});
  EXPECT_EQ(fixture.core.FindJob("a"), nullptr);
  fixture.Pass(100 * kShort_s);
  EXPECT_EQ(fixture.Info("b").state(), "queued") << "what has not ended does not grow old";
}

TEST(CoreJobs, AnEndThatIsNotDurableIsKept) {
  CoreFixture fixture(KeepFor(1));
  fixture.Submit("a");
  fixture.Do(PersistDone{"a", 1});
  fixture.Do(CancelJob{"a"});
  fixture.Pass(3 * kShort_s);
  EXPECT_TRUE(fixture.All<ForgetJob>().empty());
  fixture.Do(PersistDone{"a", 2});
  fixture.Advance(1);
  EXPECT_EQ(fixture.All<ForgetJob>().size(), 1u);
}

TEST(CoreJobs, ByDefaultJobsAreKeptForEver) {
  CoreFixture fixture;
  fixture.Submit("a");
  fixture.Do(PersistDone{"a", 1});
  fixture.Do(CancelJob{"a"});
  fixture.Do(PersistDone{"a", 2});
  fixture.Pass(10 * kShort_s);
  EXPECT_EQ(fixture.Info("a").state(), "cancelled");
}

TEST(CoreJobs, ARestartNeitherResetsAJobsAgeNorAddsToIt) {
  CoreFixture before(KeepFor(2));
  before.Do(Served{10 * kShort_s});
  before.Submit("a");
  before.Do(PersistDone{"a", 1});
  before.Pass(kShort_s);
  before.Do(CancelJob{"a"});
  const proto::Checkpoint end = before.All<Persist>().at(0).checkpoint;
  EXPECT_EQ(end.ended_served_s(), 11 * kShort_s);
  before.Do(PersistDone{"a", 2});
  before.Pass(1.5 * kShort_s);
  EXPECT_EQ(before.core.served_s(), 12.5 * kShort_s);

  CoreFixture after(KeepFor(2));
  after.now_s = 1e6 * kShort_s;  // another machine's clock, ages later
  after.Do(Served{before.core.served_s()});
  after.Do(RestoreJob{end, {}});
  after.Pass(0.4 * kShort_s);
  EXPECT_EQ(after.Info("a").state(), "cancelled") << "1.9 times";
  after.Pass(0.1 * kShort_s);
  after.Advance(1);
  EXPECT_EQ(after.All<ForgetJob>().size(), 1u) << "2.01 times";
}

TEST(CoreJobs, WhereTheTimeServedWasLostNoJobIsOlderThanItWas) {
  CoreFixture fixture(KeepFor(2));
  proto::Checkpoint end;
  end.set_job_id("a");
  end.set_number(2);
  end.set_order(1);
  *end.mutable_job() = TestJob();
  end.set_state(proto::JOB_CANCELLED);
  end.set_ended_served_s(30 * kShort_s);
  fixture.Do(Served{0});
  fixture.Do(RestoreJob{end, {}});
  EXPECT_EQ(fixture.core.served_s(), 30 * kShort_s);
  fixture.Pass(1.9 * kShort_s);
  EXPECT_EQ(fixture.Info("a").state(), "cancelled");
  fixture.Pass(0.1 * kShort_s);
  fixture.Advance(1);
  EXPECT_EQ(fixture.All<ForgetJob>().size(), 1u);
}

TEST(CoreJobs, AFailedJobThatIsRetriedIsYoungAgain) {
  CoreFixture fixture(KeepFor(2));
  fixture.Join("w");
  fixture.Submit("a");
  fixture.Do(PersistDone{"a", 1});
  fixture.Fail(fixture.Next(), "bad", true);
  fixture.Do(PersistDone{"a", 2});
  fixture.Heartbeat("w");
  fixture.Do(RetryJob{"a"});
  fixture.Do(PersistDone{"a", 3});
  fixture.Heartbeat("w", {fixture.Next()}, 1);
  fixture.Do(PauseJob{"a"});
  fixture.Do(PersistDone{"a", 4});
  fixture.Pass(3 * kShort_s);
  EXPECT_EQ(fixture.Info("a").state(), "paused") << fixture.Info("a").reason();
}

}  // namespace
}  // namespace cairn::coordinator
