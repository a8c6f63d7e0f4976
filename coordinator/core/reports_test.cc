// What is told about a job names it, and tells its story.
#include <gtest/gtest.h>

#include <algorithm>

#include "coordinator/core/testing/core_fixture.h"

namespace cairn::coordinator {
namespace {

// Of the last event, about the job; "!" before warnings, "!!" before alarms.
std::vector<std::string> Told(const CoreFixture& fixture, const std::string& job = "a") {
  std::vector<std::string> lines;
  for (const Report& report : fixture.All<Report>())
    if (report.job == job)
      lines.push_back(std::string(static_cast<std::size_t>(report.level), '!') + report.text);
  return lines;
}

using ReportLines = std::vector<std::string>;

TEST(CoreReports, AJobsStoryFromItsSubmissionToItsResult) {
  CoreFixture fixture;
  proto::Job job = TestJob();
  job.set_priority(2);
  fixture.Submit("a", job);
  EXPECT_EQ(Told(fixture), (ReportLines{"submitted: 1 stage, priority 2"}));
  fixture.Do(PersistDone{"a", 1});
  fixture.Join("w", 2);
  EXPECT_EQ(Told(fixture), ReportLines{}) << "a worker that joins is nothing to one job";
  EXPECT_EQ(Told(fixture, "").size(), 1u) << "but to the service";
  fixture.now_s += 1.5;
  fixture.AnswerPlan(fixture.Next(), TestStep(1, "iteration 0"));
  EXPECT_EQ(Told(fixture), (ReportLines{"stage 'stage0' begins, planned in 1.5 s"}));
  fixture.AnswerRun(fixture.Next(), H(1));
  EXPECT_EQ(Told(fixture), ReportLines{}) << "no line a task";
  fixture.now_s += 2;
  fixture.AnswerResult(fixture.Next(), H(2));
  EXPECT_EQ(Told(fixture),
            (ReportLines{"stage 'stage0', round 0: 1 task in 2.0 s, 0.0 s of work: iteration 0",
                         "stage 'stage0' is done"}));
  fixture.Do(PersistDone{"a", 2});
  while (!fixture.All<Persist>().empty())
    fixture.Do(PersistDone{"a", fixture.All<Persist>()[0].checkpoint.number()});
  EXPECT_EQ(Told(fixture), (ReportLines{"the result of stage 'stage0' is published", "done"}));
}

TEST(CoreReports, AFailedAttemptSaysWhyAndThatItIsTriedAgainUntilTheJobFails) {
  CoreFixture fixture;
  Begin(fixture, 1);
  fixture.Fail(fixture.Next(), "out of luck");
  EXPECT_EQ(Told(fixture),
            (ReportLines{"!task 0 (toy) of round 0 of stage 'stage0': out of luck; it is tried again"}));
  fixture.Fail(fixture.Next(), "out of luck");
  fixture.Fail(fixture.Next(), "out of luck");
  EXPECT_EQ(
      Told(fixture),
      (ReportLines{"!failed: task 0 (toy) of round 0 of stage 'stage0' failed 3 times, last: out of luck"}));
  fixture.Do(RetryJob{"a"});
  EXPECT_EQ(Told(fixture),
            (ReportLines{"retried, at round 0 of stage 'stage0', which has 0 of its 1 tasks done"}));
}

TEST(CoreReports, AWorkerThatIsLostIsNamedWithWhatBecomesOfItsTasks) {
  CoreFixture fixture;
  Begin(fixture, 3, 3);
  fixture.Do(WorkerLost{"w", true});
  EXPECT_EQ(Told(fixture),
            (ReportLines{"!task 0 (toy) of round 0 of stage 'stage0': worker 0 on host-w died while it ran; "
                         "it is tried again",
                         "!worker 0 on host-w died: 2 of the tasks that it had go elsewhere"}));
  fixture.Join("v", 1);
  fixture.Do(WorkerLeave{"v"});
  EXPECT_EQ(Told(fixture),
            (ReportLines{"worker 0 on host-v left: 1 of the tasks that it had goes elsewhere"}))
      << "nobody to blame, no warning";
}

TEST(CoreReports, WhatItsOwnerTellsAJob) {
  CoreFixture fixture;
  Begin(fixture, 2);
  fixture.Do(PrioritizeJob{"a", 3});
  EXPECT_EQ(Told(fixture), (ReportLines{"priority 3 instead of 0"}));
  fixture.Do(PauseJob{"a"});
  EXPECT_EQ(Told(fixture), (ReportLines{"paused by its owner"}));
  fixture.Do(PauseJob{"a"});
  EXPECT_EQ(Told(fixture), ReportLines{}) << "what changes nothing is not told";
  fixture.AnswerRun(fixture.Next(), H(1));
  fixture.Do(ResumeJob{"a"});
  EXPECT_EQ(Told(fixture),
            (ReportLines{"resumed, at round 0 of stage 'stage0', which has 1 of its 2 tasks done"}));
  fixture.Do(CancelJob{"a"});
  EXPECT_EQ(Told(fixture), (ReportLines{"cancelled"}));
}

TEST(CoreReports, WhatStandsStillForDaysIsNoLongRound) {
  CoreFixture fixture;
  Begin(fixture, 1);
  fixture.now_s += 1;
  fixture.Do(PauseJob{"a"});
  fixture.now_s += 1e6;
  fixture.Do(ResumeJob{"a"});
  fixture.now_s += 1;
  fixture.AnswerRun(fixture.Next(), H(1));
  fixture.AnswerPlan(fixture.Next(), TestStep(1));
  EXPECT_EQ(Told(fixture), (ReportLines{"stage 'stage0', round 0: 1 task in 2.0 s, 0.0 s of work"}));
}

TEST(CoreReports, ARestartSaysWhereTheJobGoesOn) {
  CoreFixture before;
  Begin(before, 2);
  before.AnswerRun(before.Next(), H(1));
  before.Do(PauseJob{"a"});
  const auto persists = before.All<Persist>();
  ASSERT_EQ(persists.size(), 1u);
  proto::Checkpoint checkpoint = persists[0].checkpoint;
  CoreFixture paused;
  paused.Do(RestoreJob{checkpoint, {}});
  EXPECT_EQ(Told(paused),
            (ReportLines{"the coordinator was started again: stays paused: paused by its owner"}));
  checkpoint.set_held(false);
  checkpoint.set_state(proto::JOB_RUNNING);
  CoreFixture running;
  running.Do(RestoreJob{checkpoint, {}});
  ASSERT_EQ(Told(running).size(), 1u);
  EXPECT_TRUE(Told(running)[0].starts_with("the coordinator was started again: goes on, at round 0"))
      << Told(running)[0];
}

TEST(CoreReports, ASaveThatFailsIsTold) {
  CoreFixture fixture;
  fixture.Submit();
  fixture.Do(PersistFailed{"a", 1, "no space left on device"});
  EXPECT_EQ(Told(fixture), (ReportLines{"!cannot save: no space left on device"}));
}

}  // namespace
}  // namespace cairn::coordinator
