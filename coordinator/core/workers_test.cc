// Workers: handshake, leases, hanging, stragglers, placement. Over 500 lines: a test a rule, all of one
// fixture.
#include <gtest/gtest.h>

#include "coordinator/core/testing/core_fixture.h"

namespace cairn::coordinator {
namespace {

using WorkersEnvelope = wire::Envelope;

TEST(CoreWorkers, AnotherBuildIsRefusedWithTheReason) {
  CoreFixture fixture;
  fixture.Join("w", 1, "1");
  EXPECT_EQ(fixture.Sent(&WorkersEnvelope::has_welcome).size(), 1u);
  fixture.Join("x", 1, "2");
  const auto refused = fixture.Sent(&WorkersEnvelope::has_refuse);
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_EQ(refused[0].peer, "x");
  EXPECT_EQ(refused[0].message.refuse().reason(), "version is '2', the coordinator's is '1'");
  EXPECT_EQ(fixture.core.fleet().size(), 1u);
}

TEST(CoreWorkers, AStrayOfAnotherBuildThatComesFirstIsRefusedAndCountedAndDecidesNothing) {
  CoreFixture fixture;
  fixture.Join("stray", 1, "2");
  EXPECT_EQ(fixture.core.fleet().size(), 0u);
  ASSERT_EQ(fixture.All<Refused>().size(), 1u);
  EXPECT_EQ(fixture.All<Refused>()[0].refusal.kind, wire::RefusalKind::kBuild);
  fixture.Join("w", 1, "1");
  EXPECT_EQ(fixture.Sent(&WorkersEnvelope::has_welcome).size(), 1u);
  EXPECT_EQ(fixture.core.fleet().size(), 1u);
}

TEST(CoreWorkers, AJobThatAnotherBuildBeganKeepsNobodyOutAndDoesNotGoOn) {
  CoreFixture before;
  Begin(before, 1);
  before.Fail(before.Next(), "no good", true);
  CoreOptions newer;
  newer.build = TestBuild("2");
  CoreFixture after(newer);
  after.Do(RestoreJob{before.All<Persist>().at(0).checkpoint, {}});
  after.Join("w", 1, "2");
  EXPECT_EQ(after.core.fleet().size(), 1u);
  after.Do(RetryJob{"a"});
  EXPECT_EQ(after.Info().state(), "failed");
  EXPECT_NE(after.Info().reason().find("another build"), std::string::npos);
  EXPECT_TRUE(after.assigned.empty());
}

TEST(CoreWorkers, AnotherProtocolOrNoSlotsAreRefused) {
  CoreFixture fixture;
  wire::Hello hello;
  hello.set_protocol(3);
  hello.set_slots(1);
  fixture.Do(WorkerHello{"w", hello});
  EXPECT_EQ(fixture.Sent(&WorkersEnvelope::has_refuse).size(), 1u);
  ASSERT_EQ(fixture.All<Refused>().size(), 1u);
  EXPECT_EQ(fixture.All<Refused>()[0].refusal.kind, wire::RefusalKind::kVersion);
  fixture.Join("w", 0);
  EXPECT_EQ(fixture.Sent(&WorkersEnvelope::has_refuse).size(), 1u);
  EXPECT_EQ(fixture.All<Refused>().size(), 1u);
}

TEST(CoreWorkers, AnUnknownWorkerIsAskedToSayHello) {
  CoreFixture fixture;
  fixture.Heartbeat("nobody");
  ASSERT_EQ(fixture.Sent(&WorkersEnvelope::has_unknown_worker).size(), 1u);
}

TEST(CoreWorkers, GetsAsManyTasksAsItHasSlots) {
  CoreFixture fixture;
  Begin(fixture, 5, 3);
  EXPECT_EQ(fixture.assigned.size(), 3u);
  fixture.AnswerRun(fixture.Next(), H(10));
  EXPECT_EQ(fixture.assigned.size(), 3u);
}

TEST(CoreWorkers, ALateJoinerTakesOverWhatWaitsBehindAnother) {
  CoreFixture fixture;
  Begin(fixture, 3, 3);
  fixture.assigned.clear();
  fixture.Join("late", 3);
  const auto moved = fixture.Next();
  EXPECT_EQ(moved.peer, "late");
  EXPECT_EQ(moved.assign.key().task(), 2u);
  EXPECT_EQ(moved.assign.key().attempt(), 2u);
  const auto cancels = fixture.Sent(&WorkersEnvelope::has_cancel);
  ASSERT_EQ(cancels.size(), 1u);
  EXPECT_EQ(cancels[0].peer, "w");
  EXPECT_TRUE(fixture.assigned.empty()) << "a worker that has something takes no more";
}

TEST(CoreWorkers, ATaskGoesElsewhereWhenTheLeaseExpires) {
  CoreFixture fixture;
  Begin(fixture, 1);
  const auto lost = fixture.Next();
  fixture.Join("x");
  fixture.Pass(9);
  fixture.Heartbeat("x");
  EXPECT_TRUE(fixture.assigned.empty());
  fixture.Pass(2);
  fixture.Heartbeat("x");
  const auto again = fixture.Next();
  EXPECT_EQ(again.peer, "x");
  EXPECT_EQ(again.assign.key().task(), lost.assign.key().task());
  fixture.Heartbeat("w");
  EXPECT_EQ(fixture.Sent(&WorkersEnvelope::has_unknown_worker).size(), 1u);
}

TEST(CoreWorkers, ALateAnswerOfAWithdrawnAttemptCountsBecauseTasksArePure) {
  CoreFixture fixture;
  Begin(fixture, 2, 2);
  const auto first = fixture.Next(), second = fixture.Next();
  fixture.Join("w", 2);  // says Hello again: has forgotten both
  fixture.assigned.clear();
  fixture.AnswerRun(first, H(10));
  EXPECT_EQ(fixture.Info().tasks_done(), 1u);
  EXPECT_EQ(fixture.Sent(&WorkersEnvelope::has_cancel).size(), 1u);
  fixture.Fail(second, "failure of an attempt that was withdrawn");
  EXPECT_TRUE(fixture.core.FindJob("a")->failures.empty());
}

TEST(CoreWorkers, AnAnswerToATaskThatWasNeverItsWorkersChangesNothing) {
  CoreFixture fixture;
  Begin(fixture, 2);
  const auto task = fixture.Next();
  fixture.Join("x");
  const auto other = fixture.Next();
  CoreFixture::Assigned stolen = task;  // or from before a restart of the coordinator
  stolen.peer = "x";
  fixture.Fail(stolen, "not its own", true);
  EXPECT_EQ(fixture.Info().state(), "running");
  EXPECT_EQ(fixture.All<Refused>().size(), 1u);
  fixture.AnswerRun(stolen, H(66));
  ASSERT_EQ(fixture.All<Refused>().size(), 1u);
  EXPECT_EQ(fixture.All<Refused>()[0].peer, "x");
  EXPECT_EQ(fixture.All<Refused>()[0].refusal.kind, wire::RefusalKind::kTask);
  EXPECT_EQ(fixture.All<DropBlobs>().size(), 1u) << "its blob is not kept";
  EXPECT_EQ(fixture.Info().tasks_done(), 0u);
  EXPECT_TRUE(fixture.Sent(&WorkersEnvelope::has_cancel).empty());
  fixture.AnswerRun(task, H(10));
  EXPECT_EQ(fixture.Info().tasks_done(), 1u);
  fixture.AnswerRun(stolen, H(66));
  EXPECT_EQ(fixture.Info().state(), "running") << "nor does it contradict anybody";
  EXPECT_TRUE(fixture.alarms.empty());
  CoreFixture::Assigned forged = other;
  forged.assign.mutable_key()->set_attempt(7);
  fixture.AnswerRun(forged, H(66));
  EXPECT_EQ(fixture.All<Refused>().size(), 1u);
  fixture.AnswerRun(other, H(11));
  EXPECT_TRUE(fixture.All<Refused>().empty());
  const auto plan = fixture.Next();
  CoreFixture::Assigned stolen_plan = plan;
  stolen_plan.peer = plan.peer == "x" ? "w" : "x";
  fixture.AnswerPlan(stolen_plan, TestStep(1));
  EXPECT_EQ(fixture.Info().round(), 0u);
  fixture.AnswerPlan(plan, TestStep(1));
  EXPECT_EQ(fixture.Info().round(), 1u);
}

TEST(CoreWorkers, ABlobThatAnAnswerDoesNotNameIsAFailureAndIsNotKept) {
  CoreFixture fixture;
  Begin(fixture, 2, 2);
  const auto task = fixture.Next();
  wire::Done done;
  *done.mutable_key() = task.assign.key();
  done.set_partial(H(10).Binary());
  fixture.Do(TaskDone{"w", done, {H(10), H(11)}});
  EXPECT_EQ(fixture.Info().tasks_done(), 0u);
  ASSERT_EQ(fixture.All<DropBlobs>().size(), 1u);
  EXPECT_EQ(fixture.All<DropBlobs>()[0].hashes.size(), 2u);
}

TEST(CoreWorkers, AWorkerMayReadOnlyWhatItWasHandedOrMade) {
  CoreFixture fixture;
  Begin(fixture, 1);
  fixture.Join("x");
  const auto task = fixture.Next();
  const Hash input = TaskInputs(*fixture.core.FindJob("a"), 0).at(0);
  EXPECT_TRUE(fixture.core.MayRead(task.peer, input));
  EXPECT_FALSE(fixture.core.MayRead("x", input));
  EXPECT_FALSE(fixture.core.MayRead("nobody", input));
  EXPECT_FALSE(fixture.core.MayRead(task.peer, H(4711)));
}

// By naming it in an answer: job "a" holds H(2000), job "b" is another's.
TEST(CoreWorkers, AWorkerDoesNotGetToReadABlobByNamingIt) {
  for (const bool in_a_plan : {false, true}) {
    CoreFixture fixture;
    proto::Job secret = TestJob();
    (*secret.mutable_input_blobs())["log"] = H(2000).Binary();
    fixture.Submit("a", secret);
    fixture.Do(PauseJob{"a"});
    fixture.Submit("b");
    fixture.Join("w");
    const auto start = fixture.Next();
    ASSERT_EQ(start.assign.key().job(), "b");
    if (in_a_plan) {
      proto::Step step = TestStep(1);
      (*step.mutable_state()->mutable_blobs())["mine"] = H(2000).Binary();
      fixture.AnswerPlan(start, step);
      EXPECT_EQ(fixture.core.FindJob("b")->step, std::nullopt);
    } else {
      fixture.AnswerPlan(start, TestStep(2));
      wire::Done done;
      *done.mutable_key() = fixture.Next().assign.key();
      done.set_partial(H(2000).Binary());
      fixture.Do(TaskDone{"w", done, {}});
      EXPECT_EQ(fixture.Info("b").tasks_done(), 0u);
    }
    EXPECT_FALSE(fixture.core.MayRead("w", H(2000))) << in_a_plan;
  }
}

// Nor is anything that its job holds sent again: a plan names the state's blobs of the round before.
TEST(CoreWorkers, AnAnswerMayNameWhatItsJobHolds) {
  CoreFixture fixture;
  fixture.Submit();
  fixture.Join("w");
  proto::Step step = TestStep(1);
  (*step.mutable_state()->mutable_blobs())["kept"] = H(5).Binary();
  fixture.AnswerPlan(fixture.Next(), step, {H(5)});
  fixture.AnswerRun(fixture.Next(), H(10));
  fixture.Do(WorkerLost{"w"});
  fixture.assigned.clear();
  fixture.Join("x");  // which has neither
  (*step.mutable_state()->mutable_blobs())["partial"] = H(10).Binary();
  const auto plan = fixture.Next();
  ASSERT_EQ(plan.peer, "x");
  fixture.AnswerPlan(plan, step);
  EXPECT_EQ(fixture.Info().round(), 1u);
}

// The log would fill a disk, and a job's lose its other lines.
TEST(CoreWorkers, AWorkerThatJoinsAgainAndAgainIsNotLoggedEachTime) {
  CoreFixture fixture;
  fixture.Submit();
  for (int i = 0; i < 5000; ++i) fixture.Join("w");
  EXPECT_LT(fixture.said.size(), 2100U);
  fixture.Advance(1);
  fixture.Join("x");
  EXPECT_NE(fixture.said.back().find(" joined (4000 more came or went)"), std::string::npos)
      << fixture.said.back();
}

TEST(CoreWorkers, OnlyTheRunningTaskIsBlamedForADeadWorker) {
  CoreFixture fixture;
  Begin(fixture, 2, 2);
  for (int i = 0; i < 2; ++i) {
    fixture.assigned.clear();
    fixture.Do(WorkerLost{"w"});
    fixture.Join("w", 2);
  }
  ASSERT_EQ(fixture.Info().failures_size(), 2) << "people are told";
  EXPECT_EQ(fixture.Info().retries(), 2u);
  fixture.Do(WorkerLost{"w"});
  EXPECT_EQ(fixture.Info().state(), "failed");
  EXPECT_NE(fixture.Info().reason().find("task 0 (toy)"), std::string::npos);
}

TEST(CoreWorkers, NobodyIsBlamedForAWorkerThatLeaves) {
  CoreFixture fixture;
  Begin(fixture, 1);
  for (int i = 0; i < 5; ++i) {
    fixture.Do(WorkerLeave{"w"});
    fixture.Join("w");
  }
  EXPECT_EQ(fixture.Info().state(), "running");
  EXPECT_TRUE(fixture.core.FindJob("a")->failures.empty());
}

TEST(CoreWorkers, AWorkerThatSendsHeartbeatsButDoesNotMoveHangs) {
  CoreFixture fixture;
  Begin(fixture, 1);
  const auto task = fixture.Next();
  fixture.Join("x");
  for (int i = 0; i < 65; ++i) {
    fixture.Heartbeat("w", {task}, 3);
    fixture.Heartbeat("x");
    fixture.Advance(1);
  }
  const auto again = fixture.Next();
  EXPECT_EQ(again.peer, "x");
  ASSERT_EQ(fixture.core.FindJob("a")->failures.size(), 1u);
  EXPECT_NE(fixture.core.FindJob("a")->failures[0].find("did not move"), std::string::npos);
  fixture.AnswerRun(again, H(10));
  EXPECT_EQ(fixture.Next().peer, "x") << "a worker that hangs gets nothing";
}

TEST(CoreWorkers, AWorkerWhoseTicksMoveDoesNotHang) {
  CoreFixture fixture;
  Begin(fixture, 1);
  const auto task = fixture.Next();
  for (std::uint64_t i = 0; i < 200; ++i) {
    fixture.Heartbeat("w", {task}, i + 1);
    fixture.Advance(1);
  }
  EXPECT_TRUE(fixture.assigned.empty());
  EXPECT_TRUE(fixture.core.FindJob("a")->failures.empty());
}

TEST(CoreWorkers, AHungWorkerThatMovesAgainGetsTasksAgain) {
  CoreFixture fixture;
  Begin(fixture, 1);
  const auto task = fixture.Next();
  HeartbeatUnmoved(fixture, task);
  EXPECT_TRUE(fixture.assigned.empty());
  fixture.Heartbeat("w");
  EXPECT_EQ(fixture.Next().assign.key().attempt(), 2u);
}

TEST(CoreWorkers, ATaskThatItsWorkerNeverListsIsSentAgain) {
  CoreFixture fixture;
  Begin(fixture, 1);
  const auto lost = fixture.Next();
  fixture.now_s += 3;
  fixture.Heartbeat("w");
  EXPECT_TRUE(fixture.assigned.empty());
  fixture.now_s += 2;
  fixture.Heartbeat("w");
  const auto again = fixture.Next();
  EXPECT_EQ(again.assign.key().task(), lost.assign.key().task());
  EXPECT_EQ(again.assign.key().attempt(), 2u);
  EXPECT_TRUE(fixture.core.FindJob("a")->failures.empty());
}

TEST(CoreWorkers, ATaskThatIsNotWantedIsCalledBackAtEachHeartbeat) {
  CoreFixture fixture;
  Begin(fixture, 1);
  const auto task = fixture.Next();
  fixture.Do(CancelJob{"a"});
  fixture.Heartbeat("w", {task});
  EXPECT_EQ(fixture.Sent(&WorkersEnvelope::has_cancel).size(), 1u);
}

TEST(CoreWorkers, AnIdleWorkerCopiesAStragglerAndTheFirstAnswerCounts) {
  CoreFixture fixture;
  Begin(fixture, 4);
  fixture.Join("x");
  auto on_w = fixture.Next();
  ASSERT_EQ(on_w.peer, "w");
  for (std::uint64_t i = 0; i < 3; ++i) {
    fixture.now_s += 0.5;
    fixture.AnswerRun(fixture.Next(), H(10 + i));
  }
  fixture.Heartbeat("w", {on_w}, 1);
  fixture.Advance(0.4);
  EXPECT_TRUE(fixture.assigned.empty());
  fixture.Heartbeat("x");
  fixture.Advance(0.2);
  const auto copy = fixture.Next();
  EXPECT_EQ(copy.peer, "x");
  EXPECT_EQ(copy.assign.key().task(), on_w.assign.key().task());
  fixture.Advance(1);
  EXPECT_TRUE(fixture.assigned.empty()) << "one copy is enough";
  fixture.AnswerRun(copy, H(20));
  const auto cancels = fixture.Sent(&WorkersEnvelope::has_cancel);
  ASSERT_EQ(cancels.size(), 1u);
  EXPECT_EQ(cancels[0].peer, "w");
  EXPECT_EQ(fixture.Next().assign.key().kind(), wire::TaskKey::ADVANCE);
  fixture.AnswerRun(on_w, H(20));
  EXPECT_TRUE(fixture.alarms.empty());
}

TEST(CoreWorkers, AStuckWorkerThatListsNothingGetsNothingUntilItIsFree) {
  CoreFixture fixture;
  Begin(fixture, 1);
  const auto task = fixture.Next();
  HeartbeatUnmoved(fixture, task);
  wire::Heartbeat stuck;
  stuck.set_stuck(true);
  fixture.Do(WorkerHeartbeat{"w", stuck});
  EXPECT_TRUE(fixture.assigned.empty()) << "a task would wait behind what was called back";
  fixture.Heartbeat("w");
  EXPECT_EQ(fixture.Next().assign.key().attempt(), 2u);
}

TEST(CoreWorkers, ATaskThatRunsForLongerThanItsLimitHasFailedAndThreeTimesFailTheJob) {
  CoreFixture fixture;
  proto::Job job = TestJob();
  job.set_task_time_s(5);
  fixture.Submit("a", job);
  fixture.Join("w");
  fixture.AnswerPlan(fixture.Next(), TestStep(1));
  for (int i = 0; i < 3; ++i) {
    const auto task = fixture.Next();
    EXPECT_EQ(task.assign.key().kind(), wire::TaskKey::RUN);
    for (std::uint64_t tick = 1; tick <= 6; ++tick) {
      fixture.Advance(1);
      fixture.Heartbeat("w", {task}, tick);
    }
    EXPECT_EQ(fixture.core.FindJob("a")->failures.size(), static_cast<std::size_t>(i) + 1);
    fixture.Heartbeat("w");
  }
  EXPECT_EQ(fixture.Info().state(), "failed");
  EXPECT_NE(fixture.Info().reason().find("failed 3 times, last: it ran for more than 5 s"), std::string::npos)
      << fixture.Info().reason();
}

TEST(CoreWorkers, AJobThatSaysNothingGetsTheCoordinatorsLimits) {
  CoreOptions options;
  options.task_time_s = 5;
  options.task_memory_mb = 100;
  CoreFixture fixture(options);
  Begin(fixture, 1);
  const auto task = fixture.Next();
  EXPECT_EQ(task.assign.memory_mb(), 100u);
  for (std::uint64_t tick = 1; tick <= 6; ++tick) {
    fixture.Advance(1);
    fixture.Heartbeat("w", {task}, tick);
  }
  ASSERT_EQ(fixture.core.FindJob("a")->failures.size(), 1u);
  EXPECT_NE(fixture.core.FindJob("a")->failures[0].find("--task-time-s"), std::string::npos);

  CoreFixture other(options);
  proto::Job job = TestJob();
  job.set_task_time_s(1000);
  job.set_task_memory_mb(200);
  other.Submit("a", job);
  other.Join("w");
  EXPECT_EQ(other.Next().assign.memory_mb(), 200u) << "its own limit, though it is the higher";
  other.Advance(6);
  EXPECT_TRUE(other.core.FindJob("a")->failures.empty());
}

TEST(CoreWorkers, ADrainingWorkerFinishesWhatItRunsAndTheRestGoesElsewhereWithoutBlame) {
  CoreFixture fixture;
  Begin(fixture, 4, 3);
  const auto running = fixture.Next();
  fixture.assigned.clear();
  fixture.Do(DrainWorker{"w"});
  EXPECT_EQ(fixture.Sent(&WorkersEnvelope::has_drain).size(), 1u);
  EXPECT_EQ(fixture.Sent(&WorkersEnvelope::has_cancel).size(), 2u);
  fixture.Do(DrainWorker{"w"});
  EXPECT_TRUE(fixture.actions.empty()) << "said twice it changes nothing";
  fixture.Heartbeat("w", {running}, 1);
  EXPECT_EQ(fixture.Sent(&WorkersEnvelope::has_drain).size(), 1u) << "the first word may have been lost";
  fixture.AnswerRun(running, H(10));
  EXPECT_EQ(fixture.Info().tasks_done(), 1u);
  EXPECT_TRUE(fixture.assigned.empty());
  fixture.Join("x", 3);
  EXPECT_EQ(fixture.assigned.size(), 3u);
  fixture.Do(WorkerLeave{"w"});
  EXPECT_TRUE(fixture.core.FindJob("a")->failures.empty());
  EXPECT_EQ(fixture.core.fleet().size(), 1u);
}

TEST(CoreWorkers, ADrainingWorkerThatSaysHelloAgainStillDrains) {
  CoreFixture fixture;
  Begin(fixture, 2);
  fixture.Do(DrainWorker{"w"});
  fixture.assigned.clear();
  fixture.Join("w");
  EXPECT_EQ(fixture.Sent(&WorkersEnvelope::has_drain).size(), 1u);
  EXPECT_TRUE(fixture.assigned.empty());
  EXPECT_TRUE(fixture.core.fleet().Find("w")->draining);
}

TEST(CoreWorkers, WhatADrainingWorkerRunsForTooLongIsCopiedAndWhatHangsThereGoesElsewhere) {
  CoreFixture fixture;
  Begin(fixture, 1);
  const auto task = fixture.Next();
  fixture.Do(DrainWorker{"w"});
  fixture.Join("x");
  EXPECT_TRUE(fixture.assigned.empty());
  for (int i = 0; i < 62; ++i) {
    fixture.Heartbeat("w", {task}, 1);
    fixture.Heartbeat("x");
    fixture.Advance(1);
  }
  EXPECT_EQ(fixture.Next().peer, "x");
}

// An answer that lacks its blob.
void AnswerMalformed(CoreFixture& fixture, const CoreFixture::Assigned& task) {
  wire::Done done;
  *done.mutable_key() = task.assign.key();
  done.set_partial(H(77).Binary());
  fixture.Do(TaskDone{task.peer, done, {}});
}

TEST(CoreWorkers, AWorkerWhoseAnswerIsMalformedGetsNoMoreOfThatJobWhereThereAreOthers) {
  CoreFixture fixture;
  Begin(fixture, 8, 3);
  fixture.Join("x", 2);
  auto first = fixture.Next();
  ASSERT_EQ(first.peer, "w");
  AnswerMalformed(fixture, first);
  EXPECT_EQ(fixture.Sent(&WorkersEnvelope::has_cancel).size(), 2u) << "nor are its other answers waited for";
  ASSERT_EQ(fixture.core.FindJob("a")->failures.size(), 1u);
  EXPECT_NE(fixture.core.FindJob("a")->failures[0].find("host-w"), std::string::npos) << "says whose it was";
  EXPECT_TRUE(fixture.core.fleet().Find("w")->assigned.empty());
  std::erase_if(fixture.assigned, [](const auto& task) { return task.peer == "w"; });
  for (std::uint64_t i = 0; i < 8; ++i) {
    const auto task = fixture.Next();
    EXPECT_EQ(task.peer, "x");
    fixture.AnswerRun(task, H(10 + i));
    fixture.Advance(0.1);
  }
  EXPECT_EQ(fixture.Next().assign.key().kind(), wire::TaskKey::ADVANCE);
  EXPECT_EQ(fixture.core.FindJob("a")->failures.size(), 1u);
  fixture.Submit("b");
  EXPECT_EQ(fixture.Next().peer, "w") << "other jobs do not suffer for what may be this job's fault";
}

TEST(CoreWorkers, WithNobodyElseAWorkersMalformedAnswersFailTheJobInTheEnd) {
  CoreFixture fixture;
  Begin(fixture, 1);
  fixture.Join("x");
  AnswerMalformed(fixture, fixture.Next());
  auto again = fixture.Next();
  ASSERT_EQ(again.peer, "x");
  fixture.Do(DrainWorker{"x"});
  fixture.Do(WorkerLeave{"x"});
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(fixture.Info().state(), "running");
    again = fixture.Next();
    ASSERT_EQ(again.peer, "w");
    AnswerMalformed(fixture, again);
  }
  EXPECT_EQ(fixture.Info().state(), "failed");
  EXPECT_NE(fixture.Info().reason().find("failed 3 times, last: its answer came without its blob, by worker"),
            std::string::npos)
      << fixture.Info().reason();
}

TEST(CoreWorkers, AChainStaysOnTheWorkerThatHasThePartial) {
  CoreFixture fixture;
  fixture.Submit();
  fixture.Join("v");
  fixture.Join("w");
  proto::Step step = TestStep(4);  // two chains: 0-2 and 1-3
  step.mutable_tasks(2)->mutable_inputs(0)->set_task(0);
  step.mutable_tasks(3)->mutable_inputs(0)->set_task(1);
  fixture.AnswerPlan(fixture.Next(), step);
  const auto t0 = fixture.Next(), t1 = fixture.Next();
  ASSERT_NE(t0.peer, t1.peer);
  fixture.AnswerRun(t1, H(11));
  const auto t3 = fixture.Next();
  EXPECT_EQ(t3.assign.key().task(), 3u);
  EXPECT_EQ(t3.peer, t1.peer);
}

TEST(CoreWorkers, PlacementPrefersTheWorkerThatHasTheInputsWhereBothAreFree) {
  Fleet fleet;
  wire::Hello hello;
  hello.set_slots(2);
  fleet.Add("v", hello, 0);
  fleet.NoteBlob(fleet.Add("w", hello, 0), H(1));
  EXPECT_EQ(fleet.Place(std::vector{H(1)})->peer, "w");
  EXPECT_EQ(fleet.Place(std::vector{H(2)})->peer, "v");
  fleet.Give(*fleet.Find("w"), wire::TaskKey(), 0);
  EXPECT_EQ(fleet.Place(std::vector{H(1)})->peer, "v")
      << "a free worker comes before one that has the inputs";
}

}  // namespace
}  // namespace cairn::coordinator
