// Workers: handshake, leases, hanging, stragglers, placement.
#include <gtest/gtest.h>

#include "coordinator/core/core_bench.h"

namespace cairn::coordinator {
namespace {

using WorkersEnvelope = wire::Envelope;

TEST(CoreWorkers, AnotherBuildIsRefusedWithTheReason) {
  Bench bench;
  bench.Join("w", 1, "1");
  EXPECT_EQ(bench.Sent(&WorkersEnvelope::has_welcome).size(), 1u);
  bench.Join("x", 1, "2");
  const auto refused = bench.Sent(&WorkersEnvelope::has_refuse);
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_EQ(refused[0].peer, "x");
  EXPECT_EQ(refused[0].message.refuse().reason(), "version is '2', the coordinator's is '1'");
  EXPECT_EQ(bench.core.fleet().size(), 1u);
}

TEST(CoreWorkers, AStrayOfAnotherBuildThatComesFirstIsRefusedAndCountedAndDecidesNothing) {
  Bench bench;
  bench.Join("stray", 1, "2");
  EXPECT_EQ(bench.core.fleet().size(), 0u);
  ASSERT_EQ(bench.All<Refused>().size(), 1u);
  EXPECT_EQ(bench.All<Refused>()[0].refusal.kind, wire::RefusalKind::kBuild);
  bench.Join("w", 1, "1");
  EXPECT_EQ(bench.Sent(&WorkersEnvelope::has_welcome).size(), 1u);
  EXPECT_EQ(bench.core.fleet().size(), 1u);
}

TEST(CoreWorkers, AJobThatAnotherBuildBeganKeepsNobodyOutAndDoesNotGoOn) {
  Bench before;
  Begin(before, 1);
  before.Fail(before.Next(), "no good", true);
  CoreOptions newer;
  newer.build = TestBuild("2");
  Bench after(newer);
  after.Do(RestoreJob{before.All<Persist>().at(0).checkpoint, {}});
  after.Join("w", 1, "2");
  EXPECT_EQ(after.core.fleet().size(), 1u);
  after.Do(RetryJob{"a"});
  EXPECT_EQ(after.Info().state(), "failed");
  EXPECT_NE(after.Info().reason().find("another build"), std::string::npos);
  EXPECT_TRUE(after.assigned.empty());
}

TEST(CoreWorkers, AnotherProtocolOrNoSlotsAreRefused) {
  Bench bench;
  wire::Hello hello;
  hello.set_protocol(3);
  hello.set_slots(1);
  bench.Do(WorkerHello{"w", hello});
  EXPECT_EQ(bench.Sent(&WorkersEnvelope::has_refuse).size(), 1u);
  ASSERT_EQ(bench.All<Refused>().size(), 1u);
  EXPECT_EQ(bench.All<Refused>()[0].refusal.kind, wire::RefusalKind::kVersion);
  bench.Join("w", 0);
  EXPECT_EQ(bench.Sent(&WorkersEnvelope::has_refuse).size(), 1u);
  EXPECT_EQ(bench.All<Refused>().size(), 1u);
}

TEST(CoreWorkers, AStrangerIsAskedToSayHello) {
  Bench bench;
  bench.Beat("nobody");
  ASSERT_EQ(bench.Sent(&WorkersEnvelope::has_stranger).size(), 1u);
}

TEST(CoreWorkers, GetsAsManyTasksAsItHasSlots) {
  Bench bench;
  Begin(bench, 5, 3);
  EXPECT_EQ(bench.assigned.size(), 3u);
  bench.AnswerRun(bench.Next(), H(10));
  EXPECT_EQ(bench.assigned.size(), 3u);
}

TEST(CoreWorkers, ALateJoinerTakesOverWhatWaitsBehindAnother) {
  Bench bench;
  Begin(bench, 3, 3);
  bench.assigned.clear();
  bench.Join("late", 3);
  const auto moved = bench.Next();
  EXPECT_EQ(moved.peer, "late");
  EXPECT_EQ(moved.assign.key().task(), 2u);
  EXPECT_EQ(moved.assign.key().attempt(), 2u);
  const auto cancels = bench.Sent(&WorkersEnvelope::has_cancel);
  ASSERT_EQ(cancels.size(), 1u);
  EXPECT_EQ(cancels[0].peer, "w");
  EXPECT_TRUE(bench.assigned.empty()) << "a worker that has something takes no more";
}

TEST(CoreWorkers, ATaskGoesElsewhereWhenTheLeaseExpires) {
  Bench bench;
  Begin(bench, 1);
  const auto lost = bench.Next();
  bench.Join("x");
  bench.Advance(9);
  bench.Beat("x");
  EXPECT_TRUE(bench.assigned.empty());
  bench.Advance(2);
  const auto again = bench.Next();
  EXPECT_EQ(again.peer, "x");
  EXPECT_EQ(again.assign.key().task(), lost.assign.key().task());
  bench.Beat("w");
  EXPECT_EQ(bench.Sent(&WorkersEnvelope::has_stranger).size(), 1u);
}

TEST(CoreWorkers, ALateAnswerOfAWithdrawnAttemptCountsBecauseTasksArePure) {
  Bench bench;
  Begin(bench, 2, 2);
  const auto first = bench.Next(), second = bench.Next();
  bench.Join("w", 2);  // says Hello again: has forgotten both
  bench.assigned.clear();
  bench.AnswerRun(first, H(10));
  EXPECT_EQ(bench.Info().tasks_done(), 1u);
  EXPECT_EQ(bench.Sent(&WorkersEnvelope::has_cancel).size(), 1u);
  bench.Fail(second, "failure of an attempt that was withdrawn");
  EXPECT_TRUE(bench.core.FindJob("a")->failures.empty());
}

TEST(CoreWorkers, AnAnswerToATaskThatWasNeverItsWorkersChangesNothing) {
  Bench bench;
  Begin(bench, 2);
  const auto task = bench.Next();
  bench.Join("x");
  const auto other = bench.Next();
  Bench::Assigned stolen = task;  // or from before a restart of the coordinator
  stolen.peer = "x";
  bench.Fail(stolen, "not its own", true);
  EXPECT_EQ(bench.Info().state(), "running");
  EXPECT_EQ(bench.All<Refused>().size(), 1u);
  bench.AnswerRun(stolen, H(66));
  ASSERT_EQ(bench.All<Refused>().size(), 1u);
  EXPECT_EQ(bench.All<Refused>()[0].peer, "x");
  EXPECT_EQ(bench.All<Refused>()[0].refusal.kind, wire::RefusalKind::kTask);
  EXPECT_EQ(bench.All<DropBlobs>().size(), 1u) << "its blob is not kept";
  EXPECT_EQ(bench.Info().tasks_done(), 0u);
  EXPECT_TRUE(bench.Sent(&WorkersEnvelope::has_cancel).empty());
  bench.AnswerRun(task, H(10));
  EXPECT_EQ(bench.Info().tasks_done(), 1u);
  bench.AnswerRun(stolen, H(66));
  EXPECT_EQ(bench.Info().state(), "running") << "nor does it contradict anybody";
  EXPECT_TRUE(bench.alarms.empty());
  Bench::Assigned forged = other;
  forged.assign.mutable_key()->set_attempt(7);
  bench.AnswerRun(forged, H(66));
  EXPECT_EQ(bench.All<Refused>().size(), 1u);
  bench.AnswerRun(other, H(11));
  EXPECT_TRUE(bench.All<Refused>().empty());
  const auto plan = bench.Next();
  Bench::Assigned stolen_plan = plan;
  stolen_plan.peer = plan.peer == "x" ? "w" : "x";
  bench.AnswerPlan(stolen_plan, TestStep(1));
  EXPECT_EQ(bench.Info().round(), 0u);
  bench.AnswerPlan(plan, TestStep(1));
  EXPECT_EQ(bench.Info().round(), 1u);
}

TEST(CoreWorkers, ABlobThatAnAnswerDoesNotNameIsAFailureAndIsNotKept) {
  Bench bench;
  Begin(bench, 2, 2);
  const auto task = bench.Next();
  wire::Done done;
  *done.mutable_key() = task.assign.key();
  done.set_partial(H(10).Binary());
  bench.Do(TaskDone{"w", done, {H(10), H(11)}});
  EXPECT_EQ(bench.Info().tasks_done(), 0u);
  ASSERT_EQ(bench.All<DropBlobs>().size(), 1u);
  EXPECT_EQ(bench.All<DropBlobs>()[0].hashes.size(), 2u);
}

TEST(CoreWorkers, AWorkerMayReadOnlyWhatItWasHandedOrMade) {
  Bench bench;
  Begin(bench, 1);
  bench.Join("x");
  const auto task = bench.Next();
  const Hash input = TaskInputs(*bench.core.FindJob("a"), 0).at(0);
  EXPECT_TRUE(bench.core.MayRead(task.peer, input));
  EXPECT_FALSE(bench.core.MayRead("x", input));
  EXPECT_FALSE(bench.core.MayRead("nobody", input));
  EXPECT_FALSE(bench.core.MayRead(task.peer, H(4711)));
}

TEST(CoreWorkers, OnlyTheRunningTaskIsBlamedForADeadWorker) {
  Bench bench;
  Begin(bench, 2, 2);
  for (int i = 0; i < 2; ++i) {
    bench.assigned.clear();
    bench.Do(WorkerLost{"w"});
    bench.Join("w", 2);
  }
  ASSERT_EQ(bench.Info().failures_size(), 2) << "people are told";
  EXPECT_EQ(bench.Info().retries(), 2u);
  bench.Do(WorkerLost{"w"});
  EXPECT_EQ(bench.Info().state(), "failed");
  EXPECT_NE(bench.Info().reason().find("task 0 (toy)"), std::string::npos);
}

TEST(CoreWorkers, NobodyIsBlamedForAWorkerThatLeaves) {
  Bench bench;
  Begin(bench, 1);
  for (int i = 0; i < 5; ++i) {
    bench.Do(WorkerBye{"w"});
    bench.Join("w");
  }
  EXPECT_EQ(bench.Info().state(), "running");
  EXPECT_TRUE(bench.core.FindJob("a")->failures.empty());
}

TEST(CoreWorkers, AWorkerThatBeatsButDoesNotMoveHangs) {
  Bench bench;
  Begin(bench, 1);
  const auto task = bench.Next();
  bench.Join("x");
  for (int i = 0; i < 65; ++i) {
    bench.Beat("w", {task}, 3);
    bench.Beat("x");
    bench.Advance(1);
  }
  const auto again = bench.Next();
  EXPECT_EQ(again.peer, "x");
  ASSERT_EQ(bench.core.FindJob("a")->failures.size(), 1u);
  EXPECT_NE(bench.core.FindJob("a")->failures[0].find("did not move"), std::string::npos);
  bench.AnswerRun(again, H(10));
  EXPECT_EQ(bench.Next().peer, "x") << "a worker that hangs gets nothing";
}

TEST(CoreWorkers, AWorkerWhoseTicksMoveDoesNotHang) {
  Bench bench;
  Begin(bench, 1);
  const auto task = bench.Next();
  for (std::uint64_t i = 0; i < 200; ++i) {
    bench.Beat("w", {task}, i + 1);
    bench.Advance(1);
  }
  EXPECT_TRUE(bench.assigned.empty());
  EXPECT_TRUE(bench.core.FindJob("a")->failures.empty());
}

TEST(CoreWorkers, AHungWorkerThatMovesAgainGetsTasksAgain) {
  Bench bench;
  Begin(bench, 1);
  const auto task = bench.Next();
  BeatUnmoved(bench, task);
  EXPECT_TRUE(bench.assigned.empty());
  bench.Beat("w");
  EXPECT_EQ(bench.Next().assign.key().attempt(), 2u);
}

TEST(CoreWorkers, ATaskThatItsWorkerNeverListsIsSentAgain) {
  Bench bench;
  Begin(bench, 1);
  const auto lost = bench.Next();
  bench.now_s += 3;
  bench.Beat("w");
  EXPECT_TRUE(bench.assigned.empty());
  bench.now_s += 2;
  bench.Beat("w");
  const auto again = bench.Next();
  EXPECT_EQ(again.assign.key().task(), lost.assign.key().task());
  EXPECT_EQ(again.assign.key().attempt(), 2u);
  EXPECT_TRUE(bench.core.FindJob("a")->failures.empty());
}

TEST(CoreWorkers, ATaskThatIsNotWantedIsCalledBackAtEachBeat) {
  Bench bench;
  Begin(bench, 1);
  const auto task = bench.Next();
  bench.Do(CancelJob{"a"});
  bench.Beat("w", {task});
  EXPECT_EQ(bench.Sent(&WorkersEnvelope::has_cancel).size(), 1u);
}

TEST(CoreWorkers, AnIdleWorkerCopiesAStragglerAndTheFirstAnswerCounts) {
  Bench bench;
  Begin(bench, 4);
  bench.Join("x");
  auto on_w = bench.Next();
  ASSERT_EQ(on_w.peer, "w");
  for (std::uint64_t i = 0; i < 3; ++i) {
    bench.now_s += 0.5;
    bench.AnswerRun(bench.Next(), H(10 + i));
  }
  bench.Beat("w", {on_w}, 1);
  bench.Advance(0.4);
  EXPECT_TRUE(bench.assigned.empty());
  bench.Beat("x");
  bench.Advance(0.2);
  const auto copy = bench.Next();
  EXPECT_EQ(copy.peer, "x");
  EXPECT_EQ(copy.assign.key().task(), on_w.assign.key().task());
  bench.Advance(1);
  EXPECT_TRUE(bench.assigned.empty()) << "one copy is enough";
  bench.AnswerRun(copy, H(20));
  const auto cancels = bench.Sent(&WorkersEnvelope::has_cancel);
  ASSERT_EQ(cancels.size(), 1u);
  EXPECT_EQ(cancels[0].peer, "w");
  EXPECT_EQ(bench.Next().assign.key().kind(), wire::TaskKey::ADVANCE);
  bench.AnswerRun(on_w, H(20));
  EXPECT_TRUE(bench.alarms.empty());
}

TEST(CoreWorkers, AStuckWorkerThatListsNothingGetsNothingUntilItIsFree) {
  Bench bench;
  Begin(bench, 1);
  const auto task = bench.Next();
  BeatUnmoved(bench, task);
  wire::Beat stuck;
  stuck.set_stuck(true);
  bench.Do(WorkerBeat{"w", stuck});
  EXPECT_TRUE(bench.assigned.empty()) << "a task would wait behind what was called back";
  bench.Beat("w");
  EXPECT_EQ(bench.Next().assign.key().attempt(), 2u);
}

TEST(CoreWorkers, ATaskThatRunsForLongerThanItsLimitHasFailedAndThreeTimesFailTheJob) {
  Bench bench;
  proto::Job job = TestJob();
  job.set_task_time_s(5);
  bench.Submit("a", job);
  bench.Join("w");
  bench.AnswerPlan(bench.Next(), TestStep(1));
  for (int i = 0; i < 3; ++i) {
    const auto task = bench.Next();
    EXPECT_EQ(task.assign.key().kind(), wire::TaskKey::RUN);
    for (std::uint64_t tick = 1; tick <= 6; ++tick) {
      bench.Advance(1);
      bench.Beat("w", {task}, tick);
    }
    EXPECT_EQ(bench.core.FindJob("a")->failures.size(), static_cast<std::size_t>(i) + 1);
    bench.Beat("w");
  }
  EXPECT_EQ(bench.Info().state(), "failed");
  EXPECT_NE(bench.Info().reason().find("failed 3 times, last: it ran for more than 5 s"), std::string::npos)
      << bench.Info().reason();
}

TEST(CoreWorkers, AJobThatSaysNothingGetsTheCoordinatorsLimits) {
  CoreOptions options;
  options.task_time_s = 5;
  options.task_memory_mb = 100;
  Bench bench(options);
  Begin(bench, 1);
  const auto task = bench.Next();
  EXPECT_EQ(task.assign.memory_mb(), 100u);
  for (std::uint64_t tick = 1; tick <= 6; ++tick) {
    bench.Advance(1);
    bench.Beat("w", {task}, tick);
  }
  ASSERT_EQ(bench.core.FindJob("a")->failures.size(), 1u);
  EXPECT_NE(bench.core.FindJob("a")->failures[0].find("--task-time-s"), std::string::npos);

  Bench other(options);
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
  Bench bench;
  Begin(bench, 4, 3);
  const auto running = bench.Next();
  bench.assigned.clear();
  bench.Do(DrainWorker{"w"});
  EXPECT_EQ(bench.Sent(&WorkersEnvelope::has_drain).size(), 1u);
  EXPECT_EQ(bench.Sent(&WorkersEnvelope::has_cancel).size(), 2u);
  bench.Do(DrainWorker{"w"});
  EXPECT_TRUE(bench.actions.empty()) << "said twice it changes nothing";
  bench.Beat("w", {running}, 1);
  EXPECT_EQ(bench.Sent(&WorkersEnvelope::has_drain).size(), 1u) << "the first word may have been lost";
  bench.AnswerRun(running, H(10));
  EXPECT_EQ(bench.Info().tasks_done(), 1u);
  EXPECT_TRUE(bench.assigned.empty());
  bench.Join("x", 3);
  EXPECT_EQ(bench.assigned.size(), 3u);
  bench.Do(WorkerBye{"w"});
  EXPECT_TRUE(bench.core.FindJob("a")->failures.empty());
  EXPECT_EQ(bench.core.fleet().size(), 1u);
}

TEST(CoreWorkers, ADrainingWorkerThatSaysHelloAgainStillDrains) {
  Bench bench;
  Begin(bench, 2);
  bench.Do(DrainWorker{"w"});
  bench.assigned.clear();
  bench.Join("w");
  EXPECT_EQ(bench.Sent(&WorkersEnvelope::has_drain).size(), 1u);
  EXPECT_TRUE(bench.assigned.empty());
  EXPECT_TRUE(bench.core.fleet().Find("w")->draining);
}

TEST(CoreWorkers, WhatADrainingWorkerRunsForTooLongIsCopiedAndWhatHangsThereGoesElsewhere) {
  Bench bench;
  Begin(bench, 1);
  const auto task = bench.Next();
  bench.Do(DrainWorker{"w"});
  bench.Join("x");
  EXPECT_TRUE(bench.assigned.empty());
  for (int i = 0; i < 62; ++i) {
    bench.Beat("w", {task}, 1);
    bench.Beat("x");
    bench.Advance(1);
  }
  EXPECT_EQ(bench.Next().peer, "x");
}

// An answer that lacks its blob.
void AnswerMalformed(Bench& bench, const Bench::Assigned& task) {
  wire::Done done;
  *done.mutable_key() = task.assign.key();
  done.set_partial(H(77).Binary());
  bench.Do(TaskDone{task.peer, done, {}});
}

TEST(CoreWorkers, AWorkerWhoseAnswerIsMalformedGetsNoMoreOfThatJobWhereThereAreOthers) {
  Bench bench;
  Begin(bench, 8, 3);
  bench.Join("x", 2);
  auto first = bench.Next();
  ASSERT_EQ(first.peer, "w");
  AnswerMalformed(bench, first);
  EXPECT_EQ(bench.Sent(&WorkersEnvelope::has_cancel).size(), 2u) << "nor are its other answers waited for";
  ASSERT_EQ(bench.core.FindJob("a")->failures.size(), 1u);
  EXPECT_NE(bench.core.FindJob("a")->failures[0].find("host-w"), std::string::npos) << "says whose it was";
  EXPECT_TRUE(bench.core.fleet().Find("w")->in_hand.empty());
  std::erase_if(bench.assigned, [](const auto& task) { return task.peer == "w"; });
  for (std::uint64_t i = 0; i < 8; ++i) {
    const auto task = bench.Next();
    EXPECT_EQ(task.peer, "x");
    bench.AnswerRun(task, H(10 + i));
    bench.Advance(0.1);
  }
  EXPECT_EQ(bench.Next().assign.key().kind(), wire::TaskKey::ADVANCE);
  EXPECT_EQ(bench.core.FindJob("a")->failures.size(), 1u);
  bench.Submit("b");
  EXPECT_EQ(bench.Next().peer, "w") << "other jobs do not suffer for what may be this job's fault";
}

TEST(CoreWorkers, WithNobodyElseAWorkersMalformedAnswersFailTheJobInTheEnd) {
  Bench bench;
  Begin(bench, 1);
  bench.Join("x");
  AnswerMalformed(bench, bench.Next());
  auto again = bench.Next();
  ASSERT_EQ(again.peer, "x");
  bench.Do(DrainWorker{"x"});
  bench.Do(WorkerBye{"x"});
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(bench.Info().state(), "running");
    again = bench.Next();
    ASSERT_EQ(again.peer, "w");
    AnswerMalformed(bench, again);
  }
  EXPECT_EQ(bench.Info().state(), "failed");
  EXPECT_NE(bench.Info().reason().find("failed 3 times, last: its answer came without its blob, by worker"),
            std::string::npos)
      << bench.Info().reason();
}

TEST(CoreWorkers, AChainStaysOnTheWorkerThatHasThePartial) {
  Bench bench;
  bench.Submit();
  bench.Join("v");
  bench.Join("w");
  proto::Step step = TestStep(4);  // two chains: 0-2 and 1-3
  step.mutable_tasks(2)->mutable_inputs(0)->set_task(0);
  step.mutable_tasks(3)->mutable_inputs(0)->set_task(1);
  bench.AnswerPlan(bench.Next(), step);
  const auto t0 = bench.Next(), t1 = bench.Next();
  ASSERT_NE(t0.peer, t1.peer);
  bench.AnswerRun(t1, H(11));
  const auto t3 = bench.Next();
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
