// What is told about a job names it, and tells its story.
#include <gtest/gtest.h>

#include <algorithm>

#include "coordinator/core/core_bench.h"

namespace cairn::coordinator {
namespace {

// Of the last event, about the job; "!" before warnings, "!!" before alarms.
std::vector<std::string> Told(const Bench& bench, const std::string& job = "a") {
  std::vector<std::string> lines;
  for (const Report& report : bench.All<Report>())
    if (report.job == job)
      lines.push_back(std::string(static_cast<std::size_t>(report.level), '!') + report.text);
  return lines;
}

using ReportLines = std::vector<std::string>;

TEST(CoreReports, AJobsStoryFromItsSubmissionToItsResult) {
  Bench bench;
  proto::Job job = TestJob();
  job.set_priority(2);
  bench.Submit("a", job);
  EXPECT_EQ(Told(bench), (ReportLines{"submitted: 1 stage, priority 2"}));
  bench.Do(PersistDone{"a", 1});
  bench.Join("w", 2);
  EXPECT_EQ(Told(bench), ReportLines{}) << "a worker that joins is nothing to one job";
  EXPECT_EQ(Told(bench, "").size(), 1u) << "but to the service";
  bench.now_s += 1.5;
  bench.AnswerPlan(bench.Next(), TestStep(1, "iteration 0"));
  EXPECT_EQ(Told(bench), (ReportLines{"stage 'stage0' begins, planned in 1.5 s"}));
  bench.AnswerRun(bench.Next(), H(1));
  EXPECT_EQ(Told(bench), ReportLines{}) << "no line a task";
  bench.now_s += 2;
  bench.AnswerResult(bench.Next(), H(2));
  EXPECT_EQ(Told(bench), (ReportLines{"stage 'stage0', round 0: 1 task in 2.0 s, 0.0 s of work: iteration 0",
                                      "stage 'stage0' is done"}));
  bench.Do(PersistDone{"a", 2});
  while (!bench.All<Persist>().empty())
    bench.Do(PersistDone{"a", bench.All<Persist>()[0].checkpoint.number()});
  EXPECT_EQ(Told(bench), (ReportLines{"the result of stage 'stage0' is published", "done"}));
}

TEST(CoreReports, AFailedAttemptSaysWhyAndThatItIsTriedAgainUntilTheJobFails) {
  Bench bench;
  Begin(bench, 1);
  bench.Fail(bench.Next(), "out of luck");
  EXPECT_EQ(Told(bench),
            (ReportLines{"!task 0 (toy) of round 0 of stage 'stage0': out of luck; it is tried again"}));
  bench.Fail(bench.Next(), "out of luck");
  bench.Fail(bench.Next(), "out of luck");
  EXPECT_EQ(
      Told(bench),
      (ReportLines{"!failed: task 0 (toy) of round 0 of stage 'stage0' failed 3 times, last: out of luck"}));
  bench.Do(RetryJob{"a"});
  EXPECT_EQ(Told(bench),
            (ReportLines{"retried, at round 0 of stage 'stage0', which has 0 of its 1 tasks done"}));
}

TEST(CoreReports, AWorkerThatIsLostIsNamedWithWhatBecomesOfItsTasks) {
  Bench bench;
  Begin(bench, 3, 3);
  bench.Do(WorkerLost{"w"});
  EXPECT_EQ(Told(bench),
            (ReportLines{"!task 0 (toy) of round 0 of stage 'stage0': worker 0 on host-w died while it ran; "
                         "it is tried again",
                         "!worker 0 on host-w died: 2 of the tasks that it had go elsewhere"}));
  bench.Join("v", 1);
  bench.Do(WorkerBye{"v"});
  EXPECT_EQ(Told(bench), (ReportLines{"worker 0 on host-v left: 1 of the tasks that it had goes elsewhere"}))
      << "nobody to blame, no warning";
}

TEST(CoreReports, WhatItsOwnerTellsAJob) {
  Bench bench;
  Begin(bench, 2);
  bench.Do(PrioritizeJob{"a", 3});
  EXPECT_EQ(Told(bench), (ReportLines{"priority 3 instead of 0"}));
  bench.Do(PauseJob{"a"});
  EXPECT_EQ(Told(bench), (ReportLines{"paused by its owner"}));
  bench.Do(PauseJob{"a"});
  EXPECT_EQ(Told(bench), ReportLines{}) << "what changes nothing is not told";
  bench.AnswerRun(bench.Next(), H(1));
  bench.Do(ResumeJob{"a"});
  EXPECT_EQ(Told(bench),
            (ReportLines{"resumed, at round 0 of stage 'stage0', which has 1 of its 2 tasks done"}));
  bench.Do(CancelJob{"a"});
  EXPECT_EQ(Told(bench), (ReportLines{"cancelled"}));
}

TEST(CoreReports, WhatStandsStillForDaysIsNoLongRound) {
  Bench bench;
  Begin(bench, 1);
  bench.now_s += 1;
  bench.Do(PauseJob{"a"});
  bench.now_s += 1e6;
  bench.Do(ResumeJob{"a"});
  bench.now_s += 1;
  bench.AnswerRun(bench.Next(), H(1));
  bench.AnswerPlan(bench.Next(), TestStep(1));
  EXPECT_EQ(Told(bench), (ReportLines{"stage 'stage0', round 0: 1 task in 2.0 s, 0.0 s of work"}));
}

TEST(CoreReports, ARestartSaysWhereTheJobGoesOn) {
  Bench before;
  Begin(before, 2);
  before.AnswerRun(before.Next(), H(1));
  before.Do(PauseJob{"a"});
  const auto persists = before.All<Persist>();
  ASSERT_EQ(persists.size(), 1u);
  proto::Checkpoint checkpoint = persists[0].checkpoint;
  Bench paused;
  paused.Do(RestoreJob{checkpoint, {}});
  EXPECT_EQ(Told(paused),
            (ReportLines{"the coordinator was started again: stays paused: paused by its owner"}));
  checkpoint.set_held(false);
  checkpoint.set_state(proto::JOB_RUNNING);
  Bench running;
  running.Do(RestoreJob{checkpoint, {}});
  ASSERT_EQ(Told(running).size(), 1u);
  EXPECT_TRUE(Told(running)[0].starts_with("the coordinator was started again: goes on, at round 0"))
      << Told(running)[0];
}

TEST(CoreReports, ASaveThatFailsIsTold) {
  Bench bench;
  bench.Submit();
  bench.Do(PersistFailed{"a", 1, "no space left on device"});
  EXPECT_EQ(Told(bench), (ReportLines{"!cannot save: no space left on device"}));
}

}  // namespace
}  // namespace cairn::coordinator
