// Workers that are lost and come back, and a coordinator that stood still.
#include <gtest/gtest.h>

#include "coordinator/core/testing/core_fixture.h"

namespace cairn::coordinator {
namespace {

// Over its n-th connection.
std::string Connection(int n) { return "connection " + std::to_string(n); }

// A job of one task, which the process 7 runs.
void BeginLost(CoreFixture& fixture) {
  fixture.Submit();
  fixture.Do(PersistDone{"a", 1});
  fixture.Join(Connection(0), 1, "1", 7);
  fixture.AnswerPlan(fixture.Next(), TestStep(1));
  fixture.Advance(0.1);
}

bool ReportHas(const CoreFixture& fixture, const std::string& text) {
  for (const Report& report : fixture.All<Report>())
    if (report.text.find(text) != std::string::npos) return true;
  return false;
}

TEST(CoreLost, AConnectionThatIsCutAgainAndAgainFailsNoTaskWhereItsProcessComesBack) {
  CoreFixture fixture;
  BeginLost(fixture);
  for (int i = 1; i <= 10; ++i) {
    fixture.assigned.clear();
    fixture.Do(WorkerLost{Connection(i - 1)});
    EXPECT_TRUE(ReportHas(fixture, "lost its connection"));
    EXPECT_FALSE(ReportHas(fixture, "died"));
    fixture.Pass(20);
    fixture.Join(Connection(i), 1, "1", 7);
    EXPECT_TRUE(ReportHas(fixture, "counts as no failure"));
    ASSERT_EQ(fixture.Info().state(), "running") << i;
  }
  fixture.AnswerRun(fixture.Next(), H(10));
  EXPECT_EQ(fixture.Next().assign.key().kind(), wire::TaskKey::ADVANCE);
}

TEST(CoreLost, OneThatIsBackBeforeItsLossIsNoticedIsOneWorkerAndNobodyIsBlamed) {
  CoreFixture fixture;
  BeginLost(fixture);
  for (int i = 1; i <= 10; ++i) {
    fixture.assigned.clear();
    fixture.Join(Connection(i), 1, "1", 7);
    EXPECT_EQ(fixture.Next().peer, Connection(i));
    fixture.Do(WorkerLost{Connection(i - 1)});
    EXPECT_EQ(fixture.core.fleet().size(), 1u);
  }
  EXPECT_EQ(fixture.Info().state(), "running");
  EXPECT_TRUE(fixture.core.FindJob("a")->failures.empty());
  EXPECT_LT(fixture.core.served_s(), 10) << "jobs that are kept for so long did not grow older";
}

TEST(CoreLost, OneThatComesBackAgainAndAgainWithTheSameTaskIsWarnedOf) {
  CoreFixture fixture;
  BeginLost(fixture);
  std::string warned;
  for (int i = 1; i <= 10; ++i) {
    fixture.Join(Connection(i), 1, "1", 7);
    for (const Report& report : fixture.All<Report>())
      if (report.level == Report::kWarning && report.text.find("too slow") != std::string::npos)
        warned += std::to_string(i) + " ";
  }
  EXPECT_EQ(warned, "2 4 8 ") << "rarer and rarer";
}

TEST(CoreLost, OneThatWasSilentAndIsHeardOfAgainIsNotBlamed) {
  CoreFixture fixture;
  BeginLost(fixture);
  for (int i = 0; i < 5; ++i) {
    fixture.Pass(12);
    EXPECT_EQ(fixture.core.fleet().size(), 0u);
    fixture.Join(Connection(0), 1, "1", 7);
    EXPECT_EQ(fixture.core.FindJob("a")->tasks.task(0).failures, 0);
  }
  EXPECT_EQ(fixture.Info().state(), "running");
}

// One machine after the other, each with the same task: none of them is the task's fault.
TEST(CoreLost, ABadNightOfMachinesEndsNoJobAndIsCountedApart) {
  CoreFixture fixture;
  BeginLost(fixture);
  for (int i = 1; i <= 15; ++i) {
    fixture.assigned.clear();
    fixture.Pass(12);
    EXPECT_TRUE(fixture.core.fleet().workers().empty());
    fixture.Join(Connection(i), 1, "1", 100 + static_cast<std::uint64_t>(i));
    ASSERT_EQ(fixture.Next().assign.key().kind(), wire::TaskKey::RUN) << i;
  }
  EXPECT_EQ(fixture.Info().state(), "running") << fixture.Info().reason();
  EXPECT_EQ(fixture.Info().lost(), 15u);
  EXPECT_EQ(fixture.Info().retries(), 0u);
  EXPECT_TRUE(fixture.Info().failures().empty());
  EXPECT_EQ(fixture.core.tally().lost, 15u);
  EXPECT_EQ(fixture.core.tally().retries, 0u);
  int told = 0;
  for (const std::string& line : fixture.said)
    told += line.find("is lost with") != std::string::npos &&
            line.find("no failure of the task") != std::string::npos;
  EXPECT_EQ(told, 15);
}

// It may be that the task takes its machine along.
TEST(CoreLost, ATaskThatIsLostWithEachMachineFailsItsJobInTheEnd) {
  CoreFixture fixture;
  BeginLost(fixture);
  int machines = 1;
  for (; machines < 40 && fixture.Info().state() == "running"; ++machines) {
    fixture.Pass(12);
    fixture.Join(Connection(machines), 1, "1", 100 + static_cast<std::uint64_t>(machines));
  }
  EXPECT_EQ(fixture.Info().state(), "failed");
  EXPECT_EQ(machines, 24) << "20 that were lost, and 3 failures";
  EXPECT_EQ(fixture.Info().lost(), 20u);
  EXPECT_EQ(fixture.Info().retries(), 3u);
}

// What failed and what was lost do not add up.
TEST(CoreLost, LossesInBetweenLeaveAPoisonedTaskItsThreeFailures) {
  CoreFixture fixture;
  BeginLost(fixture);
  fixture.assigned.clear();
  for (int i = 1; i <= 3; ++i) {
    EXPECT_EQ(fixture.Info().state(), "running") << i;
    fixture.Pass(12);
    fixture.Join(Connection(i), 1, "1", 100 + static_cast<std::uint64_t>(i));
    fixture.Fail(fixture.Next(), "trouble");
    fixture.assigned.clear();
  }
  EXPECT_EQ(fixture.Info().state(), "failed");
  EXPECT_EQ(fixture.Info().lost(), 3u);
}

// A switch that starts anew, a partition: all connections are gone, one a moment after the other.
TEST(CoreLost, ANetworkThatFailsForAMomentFailsNoJob) {
  for (const bool silent : {false, true}) {
    CoreFixture fixture;
    BeginLost(fixture);
    for (std::uint64_t i = 1; i < 5; ++i) {
      fixture.Join(Connection(static_cast<int>(i)), 1, "1", 7 + i);
      if (silent) fixture.Advance(0.2);
    }
    for (int i = 0; i < 5 && !silent; ++i) fixture.Do(WorkerLost{Connection(i)});
    for (int i = 0; i < 250 && silent; ++i) fixture.Advance(0.05);
    EXPECT_EQ(fixture.core.fleet().size(), 0u);
    EXPECT_EQ(fixture.Info().state(), "running") << fixture.Info().reason();
    EXPECT_EQ(fixture.core.FindJob("a")->tasks.task(0).failures, silent ? 0 : 1);
    for (std::uint64_t i = 0; i < 5; ++i) fixture.Join(Connection(static_cast<int>(10 + i)), 1, "1", 7 + i);
    EXPECT_EQ(fixture.core.FindJob("a")->tasks.task(0).failures, 0);
  }
}

// One that is heard of again is there, and gets what was lost.
TEST(CoreLost, WhatWasLostGoesToWhomIsHeardOfSince) {
  CoreFixture fixture;
  BeginLost(fixture);
  fixture.Join("another", 1, "1", 8);
  fixture.assigned.clear();
  fixture.Do(WorkerLost{Connection(0)});
  EXPECT_TRUE(fixture.assigned.empty());
  fixture.Heartbeat("another");
  EXPECT_EQ(fixture.Next().peer, "another");
}

// A supervisor starts the process again: on the same host, perhaps with the same process id.
TEST(CoreLost, ATaskThatEndsItsWorkersProcessStillFailsTheJobTheThirdTime) {
  for (const bool ended : {false, true}) {
    CoreFixture fixture;
    BeginLost(fixture);
    for (int i = 1; i <= 3; ++i) {
      EXPECT_EQ(fixture.Info().state(), "running");
      fixture.Do(WorkerLost{Connection(i - 1), ended});
      fixture.Join(Connection(i), 1, "1", static_cast<std::uint64_t>(7 + i));
    }
    EXPECT_EQ(fixture.Info().state(), "failed");
    EXPECT_NE(fixture.Info().reason().find(ended ? "died while it ran" : "lost its connection while it ran"),
              std::string::npos)
        << fixture.Info().reason();
  }
}

TEST(CoreLost, WhoSaysNotWhichProcessItIsIsBlamed) {
  CoreFixture fixture;
  Begin(fixture, 1);
  for (int i = 0; i < 3; ++i) {
    fixture.Do(WorkerLost{"w"});
    fixture.Join("w");
  }
  EXPECT_EQ(fixture.Info().state(), "failed");
}

TEST(CoreLost, OneThatComesBackTooLateIsBlamed) {
  CoreFixture fixture;
  BeginLost(fixture);
  fixture.Do(WorkerLost{Connection(0)});
  fixture.Pass(61);
  fixture.Join(Connection(1), 1, "1", 7);
  EXPECT_EQ(fixture.core.FindJob("a")->tasks.task(0).failures, 1);
}

TEST(CoreLost, WhoComesAndGoesForEverKeepsNoJobAlive) {
  for (const bool noticed : {false, true}) {
    for (const bool same_connection : {false, true}) {
      CoreFixture fixture;
      BeginLost(fixture);
      for (int i = 1; i <= 30; ++i) {
        if (noticed) fixture.Do(WorkerLost{Connection(same_connection ? 0 : i - 1)});
        fixture.Join(Connection(same_connection ? 0 : i), 1, "1", 7);
      }
      EXPECT_EQ(fixture.Info().state(), "failed") << noticed << same_connection;
    }
  }
}

TEST(CoreLost, OneThatWasToLeaveStillIsOverAnotherConnection) {
  CoreFixture fixture;
  BeginLost(fixture);
  fixture.Do(DrainWorker{Connection(0)});
  fixture.assigned.clear();
  fixture.Join(Connection(1), 1, "1", 7);
  EXPECT_TRUE(fixture.assigned.empty());
  EXPECT_TRUE(fixture.core.fleet().Find(Connection(1))->draining);
}

TEST(CoreStandstill, CountsForNobodysSilenceAndEndsNoTask) {
  CoreOptions options;
  options.task_time_s = 15;
  CoreFixture fixture(options);
  BeginLost(fixture);
  fixture.Pass(3);
  fixture.now_s += 300;
  fixture.Do(Tick{});
  EXPECT_TRUE(ReportHas(fixture, "stood still for 300 s"));
  EXPECT_EQ(fixture.core.fleet().size(), 1u);
  EXPECT_TRUE(fixture.core.FindJob("a")->failures.empty());
  fixture.Pass(5);
  EXPECT_EQ(fixture.core.fleet().size(), 1u);
  fixture.Pass(5);
  EXPECT_EQ(fixture.core.fleet().size(), 0u) << "who stays silent is lost all the same";
}

// It was sent before the worker had the task.
TEST(CoreStandstill, AHeartbeatThatWaitedToBeReadTakesNoTaskFromItsWorker) {
  CoreFixture fixture;
  BeginLost(fixture);
  fixture.now_s += 300;
  fixture.assigned.clear();
  fixture.Heartbeat(Connection(0));
  EXPECT_TRUE(fixture.assigned.empty());
  fixture.Do(Tick{});
  EXPECT_EQ(fixture.core.fleet().size(), 1u);
  EXPECT_FALSE(ReportHas(fixture, "stood still")) << "said once";
}

TEST(CoreStandstill, OneThatAlwaysComesRoundLateFindsOutWhoIsGone) {
  CoreFixture fixture;
  BeginLost(fixture);
  for (int i = 0; i < 12; ++i) {
    fixture.now_s += 8;
    fixture.Do(Tick{});
  }
  EXPECT_EQ(fixture.core.fleet().size(), 0u);
}

}  // namespace
}  // namespace cairn::coordinator
