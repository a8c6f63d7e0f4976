// Workers: handshake, leases, hanging, limits, draining.
#include <gtest/gtest.h>

#include <cmath>

#include "coordinator/core/testing/core_fixture.h"

namespace cairn::coordinator {
namespace {

TEST(CoreWorkers, OfManyEachSendsHeartbeatsLessOften) {
  CoreFixture fixture;
  double last_s = 0;
  for (int i = 0; i < 10'000; ++i) {
    fixture.Join("w" + std::to_string(i));
    last_s = fixture.Sent(&wire::Envelope::has_welcome).at(0).message.welcome().heartbeat_s();
    if (i == 100) {
      EXPECT_EQ(last_s, CoreOptions().heartbeat_s);
    }
  }
  EXPECT_EQ(last_s, 3 * CoreOptions().heartbeat_s);
  EXPECT_GE(CoreOptions().lease_s, 3 * last_s) << "and is not taken for lost where two are late";
}

TEST(CoreWorkers, OfVeryManyEachIsLookedAtLessOftenThanTenTimesASecond) {
  CoreFixture fixture;
  constexpr int kWorkers = 50'000;
  for (int i = 0; i < kWorkers; ++i) fixture.Join("w" + std::to_string(i));
  fixture.Pass(CoreOptions().lease_s - 0.2);
  for (int i = 1; i < kWorkers; ++i) fixture.Heartbeat("w" + std::to_string(i));
  fixture.Advance(0.3);
  EXPECT_EQ(fixture.core.fleet().size(), std::size_t{kWorkers}) << "it was looked at 0.3 s ago";
  fixture.Advance(0.3);
  EXPECT_EQ(fixture.core.fleet().size(), std::size_t{kWorkers - 1}) << "the one that is silent";
}

TEST(CoreWorkers, AnotherBuildIsRefusedWithTheReason) {
  CoreFixture fixture;
  fixture.Join("w", 1, "1");
  EXPECT_EQ(fixture.Sent(&wire::Envelope::has_welcome).size(), 1u);
  fixture.Join("x", 1, "2");
  const auto refused = fixture.Sent(&wire::Envelope::has_refuse);
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_EQ(refused[0].peer, "x");
  EXPECT_EQ(refused[0].message.refuse().reason(), "version is '2', the coordinator's is '1'");
  EXPECT_EQ(fixture.core.fleet().size(), 1u);
}

TEST(CoreWorkers, OfOneVersionAndOfOtherSourcesItIsAnotherBuild) {
  CoreOptions options;
  options.build = TestBuild();
  options.build.set_sources("a1");
  CoreFixture fixture(options);
  wire::Hello hello;
  hello.set_protocol(3);
  *hello.mutable_build() = options.build;
  hello.mutable_build()->set_sources("b2");
  hello.set_slots(1);
  fixture.Do(WorkerHello{"x", hello});
  const auto refused = fixture.Sent(&wire::Envelope::has_refuse);
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_EQ(refused[0].message.refuse().reason(), "hash of the sources is 'b2', the coordinator's is 'a1'");
  EXPECT_EQ(fixture.core.fleet().size(), 0u);
}

TEST(CoreWorkers, AStrayOfAnotherBuildThatComesFirstIsRefusedAndCountedAndDecidesNothing) {
  CoreFixture fixture;
  fixture.Join("stray", 1, "2");
  EXPECT_EQ(fixture.core.fleet().size(), 0u);
  ASSERT_EQ(fixture.All<Refused>().size(), 1u);
  EXPECT_EQ(fixture.All<Refused>()[0].refusal.kind, wire::RefusalKind::kBuild);
  fixture.Join("w", 1, "1");
  EXPECT_EQ(fixture.Sent(&wire::Envelope::has_welcome).size(), 1u);
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
  hello.set_protocol(4);
  hello.set_slots(1);
  fixture.Do(WorkerHello{"w", hello});
  EXPECT_EQ(fixture.Sent(&wire::Envelope::has_refuse).size(), 1u);
  ASSERT_EQ(fixture.All<Refused>().size(), 1u);
  EXPECT_EQ(fixture.All<Refused>()[0].refusal.kind, wire::RefusalKind::kVersion);
  fixture.Join("w", 0);
  EXPECT_EQ(fixture.Sent(&wire::Envelope::has_refuse).size(), 1u);
  EXPECT_EQ(fixture.All<Refused>().size(), 1u);
}

TEST(CoreWorkers, SayHowTheirMachinesAreAndSinceWhen) {
  CoreFixture fixture;
  fixture.Join("w");
  fixture.Pass(5);
  wire::Heartbeat heartbeat;
  heartbeat.set_load(1.5);
  heartbeat.set_memory_bytes(1000);
  fixture.Do(WorkerHeartbeat{"w", heartbeat});
  wire::WorkerInfo info = fixture.core.Workers().at(0);
  EXPECT_EQ(info.load(), 1.5);
  EXPECT_EQ(info.memory_bytes(), 1000u);
  EXPECT_EQ(info.joined_s(), 5);
  EXPECT_EQ(info.failures(), 0u);
  heartbeat.set_load(std::nan(""));
  fixture.Do(WorkerHeartbeat{"w", heartbeat});
  EXPECT_EQ(fixture.core.Workers().at(0).load(), 0) << "no load";
}

TEST(CoreWorkers, AnUnknownWorkerIsAskedToSayHello) {
  CoreFixture fixture;
  fixture.Heartbeat("nobody");
  ASSERT_EQ(fixture.Sent(&wire::Envelope::has_unknown_worker).size(), 1u);
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
  EXPECT_EQ(fixture.Sent(&wire::Envelope::has_unknown_worker).size(), 1u);
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
  EXPECT_EQ(fixture.Sent(&wire::Envelope::has_cancel).size(), 1u);
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
  EXPECT_EQ(fixture.Sent(&wire::Envelope::has_drain).size(), 1u);
  EXPECT_EQ(fixture.Sent(&wire::Envelope::has_cancel).size(), 2u);
  fixture.Do(DrainWorker{"w"});
  EXPECT_TRUE(fixture.actions.empty()) << "said twice it changes nothing";
  fixture.Heartbeat("w", {running}, 1);
  EXPECT_EQ(fixture.Sent(&wire::Envelope::has_drain).size(), 1u) << "the first word may have been lost";
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
  EXPECT_EQ(fixture.Sent(&wire::Envelope::has_drain).size(), 1u);
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

}  // namespace
}  // namespace cairn::coordinator
